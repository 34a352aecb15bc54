// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/result_outline.h"

#include <array>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kilter {
namespace {

using nlohmann::json;

// Counts what the lists in the root hold; everything else passes by.
class Outline : public nlohmann::json_sax<json> {
 public:
  static constexpr std::array<std::string_view, 3> kLists = {"robots", "submaps", "pairs"};

  bool null() override { return element(); }
  bool boolean(bool /*value*/) override { return element(); }
  bool number_integer(number_integer_t /*value*/) override { return element(); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return element(); }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return element(); }
  bool binary(binary_t& /*value*/) override { return element(); }
  bool string(string_t& value) override {
    if (depth_ == 1 && key_ == "schema") schema_ = value;
    return element();
  }
  bool start_object(std::size_t /*elements*/) override {
    if (depth_ == 0) is_object_ = true;
    element();
    ++depth_;
    return true;
  }
  bool end_object() override {
    --depth_;
    return true;
  }
  bool key(string_t& value) override {
    if (depth_ == 1) key_ = value;
    return true;
  }
  bool start_array(std::size_t /*elements*/) override {
    element();
    if (depth_ == 1 && is_object_) {
      for (std::size_t i = 0; i < kLists.size(); ++i) {
        if (key_ == kLists[i]) counts_[i] = 0;
      }
    }
    ++depth_;
    return true;
  }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    error_ = fmt::format("not valid JSON at byte {}: {}", position, printable(error.what(), 300));
    return false;
  }

  [[nodiscard]] Expected<ResultOutline> result(const std::string& where) const {
    if (error_) return fail(ErrorCode::kParse, *error_, where);
    if (!is_object_ || !schema_) return fail(ErrorCode::kParse, "expected a key \"schema\": this is no result", where);
    if (*schema_ != "kilter.result/1") {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("schema \"{}\"; kilter.result/1 is read", printable(*schema_, 60)), where);
    }
    for (std::size_t i = 0; i < kLists.size(); ++i) {
      if (!counts_[i]) return fail(ErrorCode::kParse, fmt::format("expected a list under \"{}\"", kLists[i]), where);
    }
    return ResultOutline{*counts_[0], *counts_[1], *counts_[2]};
  }

 private:
  bool element() {
    if (depth_ != 2 || !is_object_) return true;
    for (std::size_t i = 0; i < kLists.size(); ++i) {
      if (key_ == kLists[i] && counts_[i]) ++*counts_[i];
    }
    return true;
  }

  std::size_t depth_ = 0;
  bool is_object_ = false;
  std::string key_;
  std::optional<std::string> schema_;
  std::array<std::optional<std::size_t>, 3> counts_;
  std::optional<std::string> error_;
};

}  // namespace

Expected<ResultOutline> read_result_outline(std::string_view text, const std::string& where) {
  Outline outline;
  json::sax_parse(text.begin(), text.end(), &outline);
  return outline.result(where);
}

}  // namespace kilter
