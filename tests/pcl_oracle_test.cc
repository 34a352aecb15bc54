// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Our clouds against those of PCL, both ways: every kind of PCD and PLY that it writes. Built with KILTER_ORACLES only.
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <limits>
#include <string>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/io/cloud_file.h"
#include "kilter/report/cloud_pcd.h"
#include "kilter/report/cloud_ply.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

template <typename Point>
pcl::PointCloud<Point> random_cloud(int points) {
  pcl::PointCloud<Point> cloud;
  Rng rng(5, 0);
  for (int i = 0; i < points; ++i) {
    Point point;
    point.x = static_cast<float>(rng.uniform(-80, 80));
    point.y = static_cast<float>(rng.uniform(-80, 80));
    point.z = static_cast<float>(rng.uniform(-5, 5));
    cloud.push_back(point);
  }
  return cloud;
}

template <typename Point>
std::vector<Eigen::Vector3f> points_of(const pcl::PointCloud<Point>& cloud) {
  std::vector<Eigen::Vector3f> points_m;
  for (const Point& point : cloud) points_m.emplace_back(point.x, point.y, point.z);
  return points_m;
}

template <typename Point>
void expect_same(const std::filesystem::path& file, const pcl::PointCloud<Point>& cloud, float tolerance_m = 0.0F) {
  const auto read = read_cloud_file(file);
  ASSERT_TRUE(read) << to_string(read.error());
  const auto expected = points_of(cloud);
  ASSERT_EQ(read->points_m.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_LE((read->points_m[i] - expected[i]).cwiseAbs().maxCoeff(), tolerance_m) << file << " " << i;
  }
}

// XYZI is padded to 32 bytes, and a normal has fields behind the coordinates.
template <typename Point>
class PclOracle : public testing::Test {};
using Points = testing::Types<pcl::PointXYZ, pcl::PointXYZI, pcl::PointXYZRGB, pcl::PointNormal>;
TYPED_TEST_SUITE(PclOracle, Points);

TYPED_TEST(PclOracle, ReadsWhatPclWrites) {
  const kilter_testing::TempFolder folder;
  const auto cloud = random_cloud<TypeParam>(5000);
  const std::string base = (folder.path() / "c").string();
  pcl::io::savePCDFileASCII(base + "_ascii.pcd", cloud);
  pcl::io::savePCDFileBinary(base + "_binary.pcd", cloud);
  pcl::io::savePCDFileBinaryCompressed(base + "_packed.pcd", cloud);
  pcl::io::savePLYFileASCII(base + "_ascii.ply", cloud);
  pcl::io::savePLYFileBinary(base + "_binary.ply", cloud);
  expect_same(base + "_binary.pcd", cloud);
  expect_same(base + "_packed.pcd", cloud);
  expect_same(base + "_binary.ply", cloud);
  // PCL writes eight digits unless told otherwise.
  expect_same(base + "_ascii.pcd", cloud, 1e-5F);
  expect_same(base + "_ascii.ply", cloud, 1e-5F);
}

TEST(PclOracleAlone, DropsTheSamePointsThatPclCallsInvalid) {
  const kilter_testing::TempFolder folder;
  auto cloud = random_cloud<pcl::PointXYZ>(100);
  for (const std::size_t i : {0U, 17U, 99U}) cloud[i].y = std::numeric_limits<float>::quiet_NaN();
  cloud.is_dense = false;
  const std::string base = (folder.path() / "c").string();
  pcl::io::savePCDFileASCII(base + "_ascii.pcd", cloud);
  pcl::io::savePCDFileBinary(base + "_binary.pcd", cloud);
  pcl::io::savePCDFileBinaryCompressed(base + "_packed.pcd", cloud);
  pcl::io::savePLYFileASCII(base + "_ascii.ply", cloud);
  pcl::io::savePLYFileBinary(base + "_binary.ply", cloud);
  for (const char* kind : {"_ascii.pcd", "_binary.pcd", "_packed.pcd", "_ascii.ply", "_binary.ply"}) {
    const auto read = read_cloud_file(base + kind);
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_EQ(read->points_m.size(), 97U) << kind;
    EXPECT_EQ(read->dropped_nonfinite, 3U) << kind;
  }
}

TEST(PclOracleAlone, PclReadsWhatWeWrite) {
  const kilter_testing::TempFolder folder;
  const auto expected = points_of(random_cloud<pcl::PointXYZ>(3000));
  const std::string pcd = folder.write("c.pcd", cloud_pcd(expected)).string();
  const std::string ply = folder.write("c.ply", cloud_ply(expected, Pose3(), "map")).string();
  // A cloud each: where PCL finds no field that it takes, it says ok and leaves the points that were there before.
  pcl::PointCloud<pcl::PointXYZ> from_pcd;
  ASSERT_EQ(pcl::io::loadPCDFile(pcd, from_pcd), 0);
  EXPECT_EQ(points_of(from_pcd), expected);
  pcl::PointCloud<pcl::PointXYZ> from_ply;
  ASSERT_EQ(pcl::io::loadPLYFile(ply, from_ply), 0);
  EXPECT_EQ(points_of(from_ply), expected);
}

}  // namespace
}  // namespace kilter
