// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/point_cloud2.h"

#include <gtest/gtest.h>

#include <limits>

#include "testing/allocation_watch.h"
#include "testing/ros_bytes.h"

namespace kilter {
namespace {

using kilter_testing::cloud_message;
using kilter_testing::largest_allocation;
using kilter_testing::RosBytes;
using kilter_testing::RosDialect;

// A cloud of ROS 1 field by field; two rows of one point, doubles behind a byte, rows padded.
struct CloudParts {
  std::uint32_t height = 2;
  std::uint32_t width = 1;
  std::array<std::string, 3> names = {"x", "y", "z"};
  std::uint32_t offset = 1;
  std::uint32_t between = 8;
  std::uint8_t datatype = 8;
  std::uint32_t point_step = 25;
  std::uint32_t row_step = 30;
  std::size_t spare = 0;

  [[nodiscard]] std::string str() const {
    RosBytes bytes(RosDialect::kRos1);
    bytes.header(1, "lidar").number(height).number(width).number(std::uint32_t{3});
    for (std::uint32_t i = 0; i < 3; ++i) {
      bytes.text(names[i]).number(offset + between * i).number(datatype).number(std::uint32_t{1});
    }
    std::string data;
    for (int row = 0; row < 2; ++row) {
      data += '#';
      for (int axis = 0; axis < 3; ++axis) kilter_testing::put(data, 10.0 * row + axis);
      if (row == 0) data += "#####";
    }
    data.resize(data.size() - spare);
    bytes.number(std::uint8_t{0}).number(point_step).number(row_step).number(static_cast<std::uint32_t>(data.size()));
    return bytes.raw(data).number(std::uint8_t{1}).str();
  }
};

ErrorCode refusal(const CloudParts& parts) {
  const auto cloud = read_point_cloud2(parts.str(), MessageEncoding::kRos1, "f");
  return cloud ? ErrorCode::kInternal : cloud.error().code;
}

TEST(PointCloud2, GivesBackItsPointsInEveryDialect) {
  for (const RosDialect dialect : {RosDialect::kRos1, RosDialect::kCdrLittle, RosDialect::kCdrBig}) {
    for (const bool big_data : {false, true}) {
      for (const std::string frame : {"", "a", "li", "lid", "lidar"}) {
        const auto encoding = dialect == RosDialect::kRos1 ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
        const auto cloud = read_point_cloud2(cloud_message(dialect, 1, frame, 3, 4.0F, big_data), encoding, "f");
        ASSERT_TRUE(cloud) << to_string(cloud.error());
        ASSERT_EQ(cloud->points_m.size(), 3U);
        EXPECT_EQ(cloud->points_m[2], Eigen::Vector3f(6, 2, 3));
      }
    }
  }
}

TEST(PointCloud2, ReadsRowsWithGapsOfDoubles) {
  const auto cloud = read_point_cloud2(CloudParts().str(), MessageEncoding::kRos1, "f");
  ASSERT_TRUE(cloud) << to_string(cloud.error());
  ASSERT_EQ(cloud->points_m.size(), 2U);
  EXPECT_EQ(cloud->points_m[1], Eigen::Vector3f(10, 11, 12));
}

TEST(PointCloud2, CountsPointsThatAreNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto cloud = read_point_cloud2(cloud_message(RosDialect::kRos1, 1, "l", 2, nan), MessageEncoding::kRos1, "f");
  ASSERT_TRUE(cloud);
  EXPECT_TRUE(cloud->points_m.empty());
  EXPECT_EQ(cloud->dropped_nonfinite, 2U);
}

TEST(PointCloud2, MayBeEmpty) {
  const auto cloud = read_point_cloud2(cloud_message(RosDialect::kCdrLittle, 1, "l", 0), MessageEncoding::kCdr, "f");
  ASSERT_TRUE(cloud);
  EXPECT_TRUE(cloud->points_m.empty());
}

TEST(PointCloud2, RefusesLayoutsThatContradictTheirData) {
  EXPECT_EQ(refusal({.names = {"x", "y", "height"}}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.offset = 2}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.offset = 0xFFFFFFF8}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.between = 0}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.between = 7}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.datatype = 9}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.datatype = 0}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.point_step = 0}), ErrorCode::kParse);
  EXPECT_EQ(refusal({.height = 3}), ErrorCode::kCountMismatch);
  EXPECT_EQ(refusal({.width = 2}), ErrorCode::kCountMismatch);
  EXPECT_EQ(refusal({.row_step = 24}), ErrorCode::kCountMismatch);
  EXPECT_EQ(refusal({.row_step = 0xFFFFFFFF}), ErrorCode::kCountMismatch);
  EXPECT_EQ(refusal({.spare = 1}), ErrorCode::kCountMismatch);
}

TEST(PointCloud2, AllocatesNothingForBillionsOfPoints) {
  for (const std::uint32_t height : {1U, 2U, 0xFFFFFFFFU}) {
    const std::string bytes = CloudParts{.height = height, .width = 0xFFFFFFFF}.str();
    largest_allocation() = 0;
    EXPECT_FALSE(read_point_cloud2(bytes, MessageEncoding::kRos1, "f"));
    EXPECT_LE(largest_allocation(), 1024U);
  }
}

TEST(PointCloud2, RefusesEveryMessageCutShort) {
  for (const RosDialect dialect : {RosDialect::kRos1, RosDialect::kCdrLittle}) {
    const auto encoding = dialect == RosDialect::kRos1 ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
    const std::string bytes = cloud_message(dialect, 1, "lidar", 3);
    // The last byte says whether all points are finite, which is looked at anyway.
    for (std::size_t length = 0; length + 1 < bytes.size(); ++length) {
      EXPECT_FALSE(read_point_cloud2(bytes.substr(0, length), encoding, "f")) << length;
    }
  }
}

}  // namespace
}  // namespace kilter
