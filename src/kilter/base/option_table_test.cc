// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/option_table.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kilter {
namespace {

enum class Fruit { kApple, kPear };

TEST(OptionField, ReadsQuantitiesWithUnits) {
  double length = 0.0;
  const OptionField field = real_option("length", length, Unit::kMetre, 0.0, 100.0, "A length.");
  ASSERT_TRUE(field.assign("10 cm").has_value());
  EXPECT_DOUBLE_EQ(length, 0.1);
  ASSERT_TRUE(field.assign("2").has_value());
  EXPECT_DOUBLE_EQ(length, 2.0);
  double angle = 0.0;
  ASSERT_TRUE(real_option("angle", angle, Unit::kRadian, 0.0, 10.0, "").assign("180 deg").has_value());
  EXPECT_DOUBLE_EQ(angle, std::numbers::pi);
}

TEST(OptionField, RefusesWrongUnitsRangesAndWords) {
  double length = 1.0;
  const OptionField field = real_option("length", length, Unit::kMetre, 0.0, 100.0, "A length.");
  for (const char* text : {"5 deg", "abc", "", "-1", "nan", "101", "1 2"}) {
    const Expected<void> result = field.assign(text);
    ASSERT_FALSE(result.has_value()) << text;
    EXPECT_EQ(result.error().code, ErrorCode::kConfig);
    EXPECT_NE(result.error().message.find("length"), std::string::npos);
  }
  EXPECT_EQ(length, 1.0);
}

TEST(OptionField, TextReadsBackToTheSameValue) {
  double value = 0.1 + 0.2;
  const OptionField field = real_option("x", value, Unit::kNone, 0.0, 1.0, "");
  const std::string text = field.text();
  value = 0.0;
  ASSERT_TRUE(field.assign(text).has_value());
  EXPECT_EQ(value, 0.1 + 0.2);
}

TEST(OptionField, ChoicesIntegersAndFlags) {
  Fruit fruit = Fruit::kApple;
  const OptionField field = choice_option("fruit", fruit, {"apple", "pear"}, "");
  ASSERT_TRUE(field.assign("pear").has_value());
  EXPECT_EQ(fruit, Fruit::kPear);
  EXPECT_FALSE(field.assign("plum").has_value());
  int count = 1;
  EXPECT_FALSE(count_option("n", count, 0, 10, "").assign("1.5").has_value());
  EXPECT_TRUE(count_option("n", count, 0, 10, "").assign("7").has_value());
  EXPECT_EQ(count, 7);
  bool flag = false;
  EXPECT_TRUE(flag_option("f", flag, "").assign("true").has_value());
  EXPECT_TRUE(flag);
  EXPECT_FALSE(flag_option("f", flag, "").assign("maybe").has_value());
}

TEST(NearestName, FindsTyposAndLeavesStrangersAlone) {
  const std::vector<std::string> names = {"resolution", "submap_distance", "alpha"};
  EXPECT_EQ(nearest_name("resolutoin", names), "resolution");
  EXPECT_EQ(nearest_name("zzzzzz", names), "");
  EXPECT_EQ(nearest_name("submap", names), "submap_distance") << "what was begun is meant before what is alike";
  EXPECT_EQ(nearest_name("out", {"oft", "output"}), "oft") << "one letter from either";
  EXPECT_EQ(nearest_name("mu", {"io", "ni"}), "") << "nothing of it is left";
}

}  // namespace
}  // namespace kilter
