// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/draw_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "kilter/pipeline/check.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::furnished_room;
using testing::robot_log;

// Two robots on the same way through a room, b's map 25 cm aside.
std::vector<RobotLog> displaced_robots() {
  std::vector<Pose3> poses, wrong;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.15 * i, Eigen::Vector3d::UnitZ()));
    poses.emplace_back(turn, Eigen::Vector3d(2.01 + 0.7 * i, 2.03 + 0.25 * i, 1.02));
    wrong.push_back(Pose3::from_translation(0.0, 0.25, 0.0) * poses.back());
  }
  return {robot_log("a", furnished_room(), poses, poses, 1), robot_log("b", furnished_room(), poses, wrong, 2)};
}

Result drawn(int max_points, int threads) {
  CheckOptions options;
  options.submap.cutting.submap_distance_m = 2.0;
  options.picture.max_points = max_points;
  auto result = check(displaced_robots(), options, {}, {.threads = threads, .draw_picture = true});
  EXPECT_TRUE(result.has_value());
  return *std::move(result);
}

std::size_t points_of(const Picture& picture) {
  std::size_t points = 0;
  for (const CloudPicture& cloud : picture.clouds) points += cloud.points.size();
  return points;
}

TEST(DrawPicture, IsLeftOutUnlessAskedFor) {
  const auto result = check(displaced_robots(), {}, {}, {.threads = 2});
  EXPECT_FALSE(result->picture.has_value());
}

TEST(DrawPicture, HoldsEveryVoxelWithinTheBudgetAndNoMoreBeyond) {
  const Result all = drawn(600000, 2);
  const Result few = drawn(2000, 2);
  std::size_t voxels = 0;
  for (const SubmapSummary& submap : all.submaps) voxels += submap.occupied;
  EXPECT_EQ(points_of(*all.picture), voxels);
  EXPECT_LE(points_of(*few.picture), 2000U);
  EXPECT_GT(points_of(*few.picture), 1900U);
  std::size_t samples = 0;
  for (const PairPicture& pair : few.picture->pairs) samples += pair.source.before.size() + pair.target.before.size();
  EXPECT_LE(samples, 2U * 2000U);
  for (std::size_t i = 0; i < few.submaps.size(); ++i) {
    EXPECT_EQ(few.picture->clouds[i].voxels, few.submaps[i].occupied);
  }
}

TEST(DrawPicture, AnyNumberOfThreadsDrawsTheSame) {
  const Picture one = *drawn(5000, 1).picture;
  const Picture three = *drawn(5000, 3).picture;
  ASSERT_EQ(one.clouds.size(), three.clouds.size());
  for (std::size_t i = 0; i < one.clouds.size(); ++i) {
    EXPECT_EQ(one.clouds[i].points, three.clouds[i].points);
    EXPECT_EQ(one.clouds[i].misalignment, three.clouds[i].misalignment);
  }
  ASSERT_EQ(one.pairs.size(), three.pairs.size());
  for (std::size_t i = 0; i < one.pairs.size(); ++i) {
    EXPECT_EQ(one.pairs[i].source.before, three.pairs[i].source.before);
    EXPECT_EQ(one.pairs[i].target.after, three.pairs[i].target.after);
    EXPECT_EQ(one.pairs[i].centre_world_m, three.pairs[i].centre_world_m);
  }
}

TEST(DrawPicture, ADisplacedRobotsPointsCarryItsDisplacement) {
  const Result result = drawn(600000, 2);
  std::size_t near_25_cm = 0;
  std::size_t known = 0;
  for (const CloudPicture& cloud : result.picture->clouds) {
    for (const std::uint8_t byte : cloud.misalignment) {
      known += byte > 0;
      near_25_cm += byte >= 1 + 21 && byte <= 1 + 29;
    }
  }
  EXPECT_GT(known, points_of(*result.picture) / 2);
  EXPECT_GT(near_25_cm, known * 8 / 10);
}

TEST(DrawPicture, RegistrationBringsTheSurfacesTogether) {
  const Result result = drawn(600000, 2);
  int moved = 0;
  for (std::size_t i = 0; i < result.pairs.size(); ++i) {
    if (result.pairs[i].verdict.verdict != Verdict::kInconsistent) continue;
    const PairPicture& pair = result.picture->pairs[i];
    const auto near = [](const std::vector<std::uint8_t>& bytes) {
      return std::count_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) {
        return (byte & 127) <= 12;  // 10 cm of 1 m
      });
    };
    EXPECT_GT(near(pair.source.after), near(pair.source.before));
    ASSERT_TRUE(pair.registered_histogram.has_value());
    ++moved;
  }
  EXPECT_GT(moved, 0);
}

}  // namespace
}  // namespace kilter
