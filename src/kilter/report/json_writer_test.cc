// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/json_writer.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

TEST(JsonWriter, NumbersReadBackToTheSameDouble) {
  Rng rng(7, 0);
  std::vector<double> numbers = {0.0, -0.0, 0.1, 1.0 / 3.0, 1e-300, 5e-324, 1e20, 1.7976931348623157e308, -12.5};
  while (numbers.size() < 2000) numbers.push_back(rng.normal() * std::pow(10.0, rng.uniform(-30.0, 30.0)));
  JsonWriter json;
  const auto read = nlohmann::json::parse(json.value(std::span<const double>(numbers)).take());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto back = read[i].get<double>();
    EXPECT_EQ(back, numbers[i]);
    EXPECT_EQ(std::signbit(back), std::signbit(numbers[i])) << numbers[i];
  }
}

TEST(JsonWriter, WhatIsNotANumberBecomesNull) {
  JsonWriter json;
  json.open_list().value(std::numeric_limits<double>::infinity()).value(std::nan(""));
  json.value(std::optional<double>()).close();
  EXPECT_EQ(nlohmann::json::parse(json.take()), nlohmann::json::parse("[null, null, null]"));
}

TEST(JsonWriter, TextOfStrangersStaysValidJson) {
  const std::string odd = "quote \" slash \\ line\nbell\a tab\t caf\xC3\xA9 broken \xFF\xC3";
  const auto back = nlohmann::json::parse(json_string(odd)).get<std::string>();
  EXPECT_EQ(back, "quote \" slash \\ line\nbell\a tab\t caf\xC3\xA9 broken ??");
}

TEST(JsonWriter, KeepsTheOrderOfKeysAndNests) {
  JsonWriter json;
  json.open_object().field("b", 1).key("a").open_list().value(true).open_object().close().close();
  json.key("c").open_object(JsonWriter::Layout::kCompact).field("x", "y").key("z").open_list().value(2).value(3);
  json.close().close().close();
  EXPECT_EQ(json.take(), "{\n \"b\": 1,\n \"a\": [\n  true,\n  {}\n ],\n \"c\": {\"x\": \"y\", \"z\": [2, 3]}\n}\n");
}

}  // namespace
}  // namespace kilter
