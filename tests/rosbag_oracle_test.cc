// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Our ROS 1 bags against those of ROS's own library, both ways. Built with KILTER_ORACLES only.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "kilter/io/mission.h"
#include "testing/bag_walk.h"
#include "testing/temp_folder.h"
#include "tests/bag_by_ros.h"

namespace kilter {
namespace {

using kilter_testing::BagPacking;
using kilter_testing::RosPacking;
using kilter_testing::RosPoses;
using kilter_testing::RosStep;

constexpr double kLidarAboveBase_m = 1.25;

// Seven steps, each of another length of cloud, that fill several chunks.
std::vector<RosStep> steps() {
  std::vector<RosStep> all;
  for (int i = 0; i < 7; ++i) {
    RosStep step{1'700'000'000U + static_cast<unsigned>(i), 250'000'000U, {0.5 * i, -0.25 * i, 0.125}, {}};
    for (int point = 0; point < 2000 + i; ++point) {
      const auto along = 0.01F * static_cast<float>(point);
      step.points_m.push_back({static_cast<float>(i) + along, 100.0F - along, -1.5F * static_cast<float>(i)});
    }
    all.push_back(std::move(step));
  }
  return all;
}

class RosbagOracle : public testing::TestWithParam<std::tuple<RosPacking, RosPoses>> {};

TEST_P(RosbagOracle, ReadsWhatRosWrites) {
  const auto [packing, poses] = GetParam();
  const kilter_testing::TempFolder folder;
  const auto file = folder.path() / "run.bag";
  const std::vector<RosStep> written = steps();
  kilter_testing::write_bag_by_ros(file.string(), packing, poses, written, kLidarAboveBase_m);
  const auto mission = open_mission({file.string()});
  ASSERT_TRUE(mission) << to_string(mission.error());
  const RobotLog& log = mission->robots.front();
  ASSERT_EQ(log.T_world_cloud.size(), written.size());
  ASSERT_EQ(log.stamps_ns.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const RosStep& step = written[i];
    const Eigen::Vector3d base_m(step.position_m.data());
    EXPECT_EQ(log.T_world_cloud[i].translation_m(), base_m + Eigen::Vector3d(0, 0, kLidarAboveBase_m));
    EXPECT_EQ(log.stamps_ns[i], std::int64_t{1'000'000'000} * step.seconds + step.nanoseconds);
    const auto cloud = log.read_cloud(i);
    ASSERT_TRUE(cloud) << to_string(cloud.error());
    ASSERT_EQ(cloud->points_m.size(), step.points_m.size());
    for (std::size_t k = 0; k < step.points_m.size(); ++k) {
      ASSERT_EQ(cloud->points_m[k], Eigen::Vector3f(step.points_m[k].data()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EachPackingAndPose, RosbagOracle,
                         testing::Combine(testing::Values(RosPacking::kNone, RosPacking::kBz2, RosPacking::kLz4),
                                          testing::Values(RosPoses::kOdometry, RosPoses::kPoseStamped, RosPoses::kPath,
                                                          RosPoses::kTransforms)));

TEST(RosbagOracleAlone, RosReadsTheFixturesThatOurTestsRestOn) {
  const auto messages = kilter_testing::small_drive(kilter_testing::RosDialect::kRos1);
  std::vector<std::string> ours;
  for (const auto& message : messages) ours.push_back(message.bytes);
  std::sort(ours.begin(), ours.end());
  for (const auto packing : {BagPacking::kNone, BagPacking::kBz2, BagPacking::kLz4}) {
    SCOPED_TRACE(static_cast<int>(packing));
    const kilter_testing::TempFolder folder;
    const auto file = folder.write("run.bag", kilter_testing::rosbag1_bytes(messages, {.packing = packing}));
    std::vector<std::string> theirs = kilter_testing::read_bag_by_ros(file.string());
    std::sort(theirs.begin(), theirs.end());
    EXPECT_EQ(theirs, ours);
  }
}

}  // namespace
}  // namespace kilter
