// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/frame_offset.h"

#include <gtest/gtest.h>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

Pose3 turned(double degrees, const Eigen::Vector3d& shift_m) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(degrees * 0.017453292519943295, Eigen::Vector3d::UnitZ())), shift_m};
}

// Registrations at many places that all ask for one motion, give or take `noise_m` and a few minutes of arc.
std::vector<FrameWitness> witnesses_of(const Pose3& motion, std::size_t count, double noise_m, std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<FrameWitness> witnesses;
  for (std::size_t i = 0; i < count; ++i) {
    FrameWitness witness;
    witness.target_robot = 0;
    witness.source_robot = 1;
    witness.middle_world_m = {rng.uniform(-40.0, 40.0), rng.uniform(-40.0, 40.0), rng.uniform(0.0, 2.0)};
    witness.radius_m = 5.0;
    const Eigen::Vector3d off_m(rng.uniform(-noise_m, noise_m), rng.uniform(-noise_m, noise_m), 0.0);
    const Pose3 about = Pose3(Eigen::Quaterniond::Identity(), witness.middle_world_m);
    witness.T_world_correction = Pose3(Eigen::Quaterniond::Identity(), off_m) * motion * about *
                                 turned(rng.uniform(-0.1, 0.1), Eigen::Vector3d::Zero()) * about.inverse();
    witnesses.push_back(witness);
  }
  return witnesses;
}

TEST(FindFrameOffsets, FindsTheOneMotionThatAllAskFor) {
  const Pose3 motion = turned(1.0, {0.3, -0.1, 0.05});
  const std::vector<FrameWitness> witnesses = witnesses_of(motion, 30, 0.02, 1);
  const std::vector<FrameOffset> found = find_frame_offsets(witnesses, 0.1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].target_robot, 0);
  EXPECT_EQ(found[0].source_robot, 1);
  EXPECT_EQ(found[0].agreeing, 30U);
  EXPECT_EQ(found[0].witnesses, 30U);
  const Pose3 left = found[0].T_world_correction.inverse() * motion;
  EXPECT_LT(left.angle_rad(), 5e-4);
  const Eigen::Vector3d& middle_m = found[0].middle_world_m;
  EXPECT_LT((left * middle_m - middle_m).norm(), 0.01);
  EXPECT_LT((found[0].shift_m - (motion * middle_m - middle_m)).norm(), 0.01);
  EXPECT_GT(found[0].offset_m, 0.3);
}

TEST(FindFrameOffsets, SomeThatAreWrongDoNotHideIt) {
  std::vector<FrameWitness> witnesses = witnesses_of(turned(0.0, {0.5, 0.0, 0.0}), 17, 0.02, 2);
  for (const FrameWitness& wrong : witnesses_of(turned(0.0, {4.3, 0.0, 0.0}), 3, 0.02, 3)) witnesses.push_back(wrong);
  const std::vector<FrameOffset> found = find_frame_offsets(witnesses, 0.1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].agreeing, 17U);
  EXPECT_EQ(found[0].witnesses, 20U);
  EXPECT_NEAR(found[0].shift_m.x(), 0.5, 0.02);
}

TEST(FindFrameOffsets, SaysNothingWherePairsAskForDifferentMotions) {
  std::vector<FrameWitness> drifted;
  for (int i = 0; i < 12; ++i) {
    FrameWitness witness = witnesses_of(turned(0.0, {0.2 * i, 0.0, 0.0}), 1, 0.0, 4)[0];
    drifted.push_back(witness);
  }
  EXPECT_TRUE(find_frame_offsets(drifted, 0.1).empty());
}

TEST(FindFrameOffsets, SaysNothingOfFramesThatAgreeOrOfTooFewPairs) {
  EXPECT_TRUE(find_frame_offsets(witnesses_of(turned(0.0, {0.05, 0.0, 0.0}), 20, 0.02, 5), 0.1).empty());
  EXPECT_TRUE(find_frame_offsets(witnesses_of(turned(0.0, {0.5, 0.0, 0.0}), 2, 0.0, 6), 0.1).empty());
  EXPECT_TRUE(find_frame_offsets({}, 0.1).empty());
}

// A robot's own pairs, and those with a third one, are asked apart.
TEST(FindFrameOffsets, KeepsRobotsApart) {
  std::vector<FrameWitness> witnesses = witnesses_of(turned(0.0, {0.5, 0.0, 0.0}), 5, 0.01, 7);
  for (FrameWitness other : witnesses_of(turned(0.0, {0.0, 0.7, 0.0}), 5, 0.01, 8)) {
    other.source_robot = 2;
    witnesses.insert(witnesses.begin(), other);
    other.target_robot = 2;
    witnesses.push_back(other);
  }
  const std::vector<FrameOffset> found = find_frame_offsets(witnesses, 0.1);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].source_robot, 1);
  EXPECT_EQ(found[1].source_robot, 2);
  EXPECT_NEAR(found[1].shift_m.y(), 0.7, 0.02);
}

}  // namespace
}  // namespace kilter
