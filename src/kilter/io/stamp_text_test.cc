// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/stamp_text.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

using Stamps = std::vector<StampText>;

Stamps of(std::initializer_list<std::string_view> words) {
  Stamps stamps;
  for (const std::string_view word : words) stamps.push_back(parse_stamp_text(word).value());
  return stamps;
}

TEST(StampText, KeepsEveryDigit) {
  EXPECT_EQ(parse_stamp_text("1403636579.763555584"), (StampText{1403636579, 763555584, true}));
  EXPECT_EQ(parse_stamp_text("1403636579763555584"), (StampText{1403636579763555584, 0, false}));
  EXPECT_EQ(parse_stamp_text("12."), (StampText{12, 0, true}));
  EXPECT_EQ(parse_stamp_text("0.12345678999"), (StampText{0, 123456789, true}));
  EXPECT_EQ(parse_stamp_text("1.5e+01"), (StampText{15, 0, true}));
  EXPECT_EQ(parse_stamp_text("2.5E0"), (StampText{2, 500000000, true}));
}

TEST(StampText, IsNothingForOtherWords) {
  for (const char* word :
       {"", "-1", "1x", ".5", "1.2.3", "1.-2", "nan", "inf", "1e30", "-1e3", "e", "9223372036854775808"}) {
    EXPECT_FALSE(parse_stamp_text(word)) << word;
  }
}

TEST(StampText, StandsInNamesOfClouds) {
  EXPECT_EQ(stamp_of_file("1403636579.763555.pcd"), (StampText{1403636579, 763555000, true}));
  EXPECT_EQ(stamp_of_file("1403636579_063555584.pcd"), (StampText{1403636579, 63555584, true}));
  EXPECT_EQ(stamp_of_file("1403636579_63.pcd"), (StampText{1403636579, 63, true}));
  EXPECT_EQ(stamp_of_file("12_500000000.pcd"), (StampText{12, 500000000, true}));
  EXPECT_EQ(stamp_of_file("cloud_12.5.ply"), (StampText{12, 500000000, true}));
  EXPECT_EQ(stamp_of_file("000012.bin"), (StampText{12, 0, false}));
  for (const char* name : {"map.pcd", "a1_b.pcd", "1_2_3.pcd", "robot1_000012.pcd", "1_9999999999.pcd", ".pcd", ""}) {
    EXPECT_FALSE(stamp_of_file(name)) << name;
  }
}

TEST(StampText, TellsStampsFromCounts) {
  EXPECT_FALSE(look_like_stamps(of({"0", "1", "999999"})));
  EXPECT_TRUE(look_like_stamps(of({"0.0", "0.1"})));
  EXPECT_TRUE(look_like_stamps(of({"1403636579"})));
  EXPECT_TRUE(look_like_stamps(of({"1403636579763555584"})));
  EXPECT_FALSE(look_like_stamps({}));
  const auto in_names = [](std::initializer_list<const char*> names) {
    std::vector<StampText> stamps;
    for (const char* name : names) stamps.push_back(*stamp_of_file(name));
    return stamps;
  };
  EXPECT_TRUE(look_like_stamps(in_names({"12_500000000.pcd", "12_600000000.pcd", "13_000000000.pcd"})));
  EXPECT_FALSE(look_like_stamps(in_names({"lidar0_000000012.bin", "lidar0_000000013.bin"}))) << "a counter";
  EXPECT_FALSE(look_like_stamps(in_names({"20231114_221459900.bin", "20231114_221500000.bin"})))
      << "a day and its time";
}

TEST(StampText, GuessesTheUnitByMagnitudeAndStep) {
  EXPECT_EQ(guess_unit(of({"1403636579.7", "1403636579.8"})), StampUnit::kSeconds);
  EXPECT_EQ(guess_unit(of({"1403636579763", "1403636579863"})), StampUnit::kMilliseconds);
  EXPECT_EQ(guess_unit(of({"1403636579763555", "1403636579863555"})), StampUnit::kMicroseconds);
  EXPECT_EQ(guess_unit(of({"1403636579763555584"})), StampUnit::kNanoseconds);
  EXPECT_EQ(guess_unit(of({"0", "1", "2"})), StampUnit::kSeconds);
  EXPECT_EQ(guess_unit(of({"0", "100000000", "200000000"})), StampUnit::kNanoseconds);
  EXPECT_EQ(guess_unit(of({"0", "100000", "200000"})), StampUnit::kMicroseconds);
  // Nanoseconds of a clock that began 40 minutes ago, not milliseconds of this century.
  EXPECT_EQ(guess_unit(of({"2400000000000", "2400100000000", "2400200000000"})), StampUnit::kNanoseconds);
  EXPECT_EQ(guess_unit({}), StampUnit::kSeconds);
}

TEST(StampText, BecomesNanosecondsOrNothing) {
  EXPECT_EQ(to_nanoseconds(of({"1403636579.763555584"}), StampUnit::kSeconds).value().front(), 1403636579763555584);
  EXPECT_EQ(to_nanoseconds(of({"5.25"}), StampUnit::kMilliseconds).value().front(), 5250000);
  EXPECT_EQ(to_nanoseconds(of({"5"}), StampUnit::kMicroseconds).value().front(), 5000);
  EXPECT_EQ(to_nanoseconds(of({"1403636579763555584.9"}), StampUnit::kNanoseconds).value().front(),
            1403636579763555584);
  EXPECT_FALSE(to_nanoseconds(of({"1403636579763555584"}), StampUnit::kSeconds));
}

TEST(StampText, ShowsItsRange) {
  EXPECT_EQ(range_of(of({"2.5", "1.25"}), StampUnit::kSeconds), "1.250 to 2.500, in s");
  EXPECT_EQ(range_of(of({"7"}), StampUnit::kNanoseconds), "7 to 7, in ns");
}

}  // namespace
}  // namespace kilter
