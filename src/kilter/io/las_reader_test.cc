// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/las_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kilter/io/cloud_file.h"
#include "testing/allocation_watch.h"
#include "testing/las_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::las_record;
using kilter_testing::LasBytes;

void expect_points(const Expected<PointCloud>& cloud) {
  ASSERT_TRUE(cloud) << to_string(cloud.error());
  ASSERT_EQ(cloud->points_m.size(), 2U);
  // 1000 * 0.001 + 100, -2500 * 0.001, 700 * 0.01 - 5.
  EXPECT_TRUE(cloud->points_m[0].isApprox(Eigen::Vector3f(101.0F, -2.5F, 2.0F)));
  EXPECT_TRUE(cloud->points_m[1].isApprox(Eigen::Vector3f(0.0F, 0.001F, 0.0F), 1e-5F)) << cloud->points_m[1];
}

template <typename Change>
Expected<PointCloud> read_with(const Change& change, LasBytes las = {}) {
  change(las);
  return read_las(las.str(), "f");
}

void expect_error(const Expected<PointCloud>& cloud, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(cloud) << part;
  EXPECT_EQ(error_code_name(cloud.error().code), error_code_name(code)) << to_string(cloud.error());
  EXPECT_NE(to_string(cloud.error()).find(part), std::string::npos) << to_string(cloud.error());
}

TEST(LasReader, ScalesAndShiftsWholeNumbers) { expect_points(read_las(LasBytes().str(), "f")); }

TEST(LasReader, CountsPointsFromTheHeaderAlone) {
  const std::string bytes = LasBytes().str();
  EXPECT_EQ(read_las_count(bytes.substr(0, 227), "f"), 2U);
  EXPECT_EQ(read_las_count(bytes.substr(0, 226), "f").error().code, ErrorCode::kTruncated);
  const std::string newer = LasBytes::version_1_4().str();
  EXPECT_EQ(read_las_count(newer.substr(0, 375), "f"), 2U);
  EXPECT_EQ(read_las_count(newer.substr(0, 374), "f").error().code, ErrorCode::kTruncated);
  const kilter_testing::TempFolder folder;
  EXPECT_EQ(peek_cloud_file(folder.write("a.las", newer))->points, 2U);
}

TEST(LasReader, ReadsEveryVersionAndPointFormat) {
  for (const int minor : {0, 1, 2, 3}) {
    expect_points(read_with([&](LasBytes& l) { l.minor = static_cast<std::uint8_t>(minor); }));
  }
  expect_points(read_las(LasBytes::version_1_4().str(), "f"));
  constexpr std::array kLeast = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  for (std::size_t format = 0; format < kLeast.size(); ++format) {
    const auto with_bytes = [&](int bytes) {
      return read_with([&](LasBytes& l) {
        l.format = static_cast<std::uint8_t>(format);
        l.point_bytes = static_cast<std::uint16_t>(bytes);
      });
    };
    expect_points(with_bytes(kLeast[format]));
    expect_points(with_bytes(kLeast[format] + 5));
    expect_error(with_bytes(kLeast[format] - 1), ErrorCode::kParse, "point of format");
  }
}

TEST(LasReader, PassesOverRecordsAndWhatFollowsThePoints) {
  LasBytes las;
  las.records = 2;
  las.record_bytes = las_record("projection") + las_record("") + "padding";
  las.points_at += static_cast<std::uint32_t>(las.record_bytes.size());
  expect_points(read_las(las.str() + "extended records", "f"));
  las.records = 3;
  expect_error(read_las(las.str(), "f"), ErrorCode::kTruncated, "number 2 reaches beyond");
  las.records = 4000000000U;
  expect_error(read_las(las.str(), "f"), ErrorCode::kTruncated, "4000000000");
}

TEST(LasReader, TakesEitherCountOfVersion14) {
  const LasBytes newer = LasBytes::version_1_4();
  expect_points(read_with([](LasBytes& l) { l.old_count = 2; }, newer));
  expect_points(read_with(
      [](LasBytes& l) {
        l.old_count = 2;
        l.count = 0;
      },
      newer));
  expect_error(read_with([](LasBytes& l) { l.old_count = 1; }, newer), ErrorCode::kCountMismatch, "older readers");
}

TEST(LasReader, SaysWhatToDoAboutCompressionAndOtherVersions) {
  expect_error(read_with([](LasBytes& l) { l.format |= 0x80; }), ErrorCode::kUnsupported, "laszip -i");
  expect_error(read_with([](LasBytes& l) { l.format = 11; }), ErrorCode::kUnsupported, "point format 11");
  expect_error(read_with([](LasBytes& l) { l.minor = 5; }), ErrorCode::kUnsupported, "1.5");
  expect_error(read_with([](LasBytes& l) { l.signature = "LAZF"; }), ErrorCode::kParse, "LASF");
}

TEST(LasReader, RefusesHeadersThatContradictThemselves) {
  expect_error(read_with([](LasBytes& l) { l.points_at = 226; }), ErrorCode::kParse, "points come after it");
  expect_error(read_with([](LasBytes& l) { l.points_at = 4000000000U; }), ErrorCode::kTruncated, "4000000000");
  expect_error(read_with([](LasBytes& l) { l.header_bytes = 235; }, LasBytes::version_1_4()), ErrorCode::kParse, "375");
  for (const double odd : {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expect_error(read_with([&](LasBytes& l) { l.scale[1] = odd; }), ErrorCode::kParse, "axis 1");
  }
  expect_error(read_with([](LasBytes& l) { l.offset_m[2] = NAN; }), ErrorCode::kParse, "axis 2");
}

TEST(LasReader, AllocatesNothingForPromises) {
  LasBytes las = LasBytes::version_1_4();
  for (const std::uint64_t count : {std::uint64_t{3}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    las.count = count;
    kilter_testing::largest_allocation() = 0;
    expect_error(read_las(las.str(), "f"), ErrorCode::kTruncated, "only 60 bytes follow");
    EXPECT_LE(kilter_testing::largest_allocation(), 4096U);
  }
}

TEST(LasReader, ExplainsGeoreferencedClouds) {
  const auto utm = [](LasBytes& l) { l.offset_m = {691234.0, 5334567.0, 520.0}; };
  expect_error(read_with(utm), ErrorCode::kInvalidPoints, "subtract an offset, say 691200 5334500 500");
  const auto half = read_with([](LasBytes& l) { l.points[1][1] = 2000000000; });
  ASSERT_TRUE(half);
  EXPECT_EQ(half->points_m.size(), 1U);
  EXPECT_EQ(half->dropped_far, 1U);
}

TEST(LasReader, TakesAFileWithoutPoints) {
  const auto cloud = read_with([](LasBytes& l) {
    l.old_count = 0;
    l.points.clear();
  });
  ASSERT_TRUE(cloud);
  EXPECT_TRUE(cloud->points_m.empty());
}

TEST(LasReader, IsChosenByTheNameOfTheFile) {
  const kilter_testing::TempFolder folder;
  expect_points(read_cloud_file(folder.write("a.LAS", LasBytes().str())));
}

}  // namespace
}  // namespace kilter
