// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/slam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kilter/simulation/closures.h"
#include "kilter/simulation/route.h"

namespace kilter {
namespace {

RobotMotion motion(const std::string& name, const std::vector<Eigen::Vector3d>& corners_m) {
  const Trajectory drive = Trajectory::along(corners_m, {});
  RobotMotion robot{name, {}, {}};
  for (const double time_s : drive.scan_times_s(0.7, 0.5)) {
    robot.T_world_sensor.push_back(drive.at(time_s));
    robot.path_m.push_back(drive.path_m(time_s));
  }
  return robot;
}

// Two robots, each round its own rectangle; they share the side x = 20 and both come back to their starts.
std::vector<RobotMotion> two_rings() {
  return {motion("a", {{0, 0, 0}, {20, 0, 0}, {20, 12, 0}, {0, 12, 0}, {0, 0, 0}, {8, 0, 0}}),
          motion("b", {{40, 0, 0}, {20, 0, 0}, {20, 12, 0}, {40, 12, 0}, {40, 0, 0}, {32, 0, 0}})};
}

double worst_step_m(const RobotMotion& truth, const std::vector<Pose3>& estimate) {
  double worst_m = 0.0;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    worst_m = std::max(
        worst_m, relative_error(truth.T_world_sensor[i - 1], truth.T_world_sensor[i], estimate[i - 1], estimate[i])
                     .head<3>()
                     .norm());
  }
  return worst_m;
}

// Worst disagreement where robots come back to places, however the back end treated them. [m]
double worst_meeting_m(const std::vector<RobotMotion>& truth, const SlamResult& result) {
  double worst_m = 0.0;
  for (const Meeting& meeting : find_meetings(truth, {})) {
    const auto [a, b] = std::pair(meeting.earlier, meeting.later);
    const Vector6 error =
        relative_error(truth[a.robot].T_world_sensor[a.scan], truth[b.robot].T_world_sensor[b.scan],
                       result.T_world_sensor[a.robot][a.scan], result.T_world_sensor[b.robot][b.scan]);
    worst_m = std::max(worst_m, error.head<3>().norm());
  }
  return worst_m;
}

SlamResult solve(const std::vector<RobotMotion>& truth, const std::vector<FaultRequest>& faults, std::uint64_t seed = 1,
                 const SlamOptions& options = {}) {
  Expected<SlamResult> result = run_slam(truth, faults, options, seed);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return *result;
}

TEST(Slam, GoodMissionAgreesWithItselfToCentimetres) {
  const auto truth = two_rings();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SlamResult result = solve(truth, {}, seed);
    EXPECT_LT(worst_meeting_m(truth, result), 0.06) << seed;
    EXPECT_LT(worst_step_m(truth[0], result.T_world_sensor[0]), 0.03);
    EXPECT_TRUE(result.faults.empty());
  }
}

TEST(Slam, WithoutClosuresDriftShowsWhereTheRobotComesBack) {
  const auto truth = two_rings();
  const SlamOptions options{.within_robots = false, .between_robots = false};
  double sum_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) sum_m += worst_meeting_m(truth, solve(truth, {}, seed, options));
  EXPECT_GT(sum_m / 20.0, 0.15);
}

TEST(Slam, SlipIsOneStepOfTheAskedSizeAtATurn) {
  const auto truth = two_rings();
  const SlamResult result = solve(truth, {{.kind = FaultKind::kSlip, .at = 0.5, .size_m = 0.4, .size_rad = 0.05}});
  const Fault& slip = result.faults.at(0);
  EXPECT_EQ(slip.first_scan + 1, slip.scan);
  EXPECT_NEAR(slip.size_m, 0.4, 0.03);
  EXPECT_NEAR(slip.size_rad, 0.05, 0.01);
  const Pose3 step = truth[0].T_world_sensor[slip.scan - 1].inverse() * truth[0].T_world_sensor[slip.scan];
  EXPECT_GT(step.angle_rad(), 0.3) << "a sharp turn";
  EXPECT_GT(worst_meeting_m(truth, result), 0.2) << "and nothing pulls it back";
}

TEST(Slam, MissedClosureHasTheAskedSizeAndNoStepShowsIt) {
  const auto truth = two_rings();
  for (const double size_m : {0.3, 1.0, 5.0}) {
    const SlamResult result = solve(truth, {{.kind = FaultKind::kMissedClosure, .robot = 1, .size_m = size_m}});
    const Fault& missed = result.faults.at(0);
    EXPECT_EQ(missed.robot, 1);
    EXPECT_NEAR(missed.size_m, size_m, 0.03 * size_m);
    EXPECT_LT(distance_m(truth, {1, missed.scan}, {1, missed.against_scan}), 3.0);
    EXPECT_LT(worst_step_m(truth[1], result.T_world_sensor[1]), 0.03 + size_m / 30.0);
    EXPECT_LT(worst_step_m(truth[0], result.T_world_sensor[0]), 0.03) << "the other robot is not touched";
  }
}

TEST(Slam, FrameOffsetMovesOneRobotAsAWhole) {
  const auto truth = two_rings();
  const SlamResult good = solve(truth, {});
  const SlamResult bad = solve(truth, {{.kind = FaultKind::kFrameOffset, .robot = 1, .size_m = 0.5, .size_rad = 0.02}});
  EXPECT_NEAR(bad.faults.at(0).size_m, 0.5, 0.08);
  EXPECT_EQ(bad.faults.at(0).against_robot, 0);
  EXPECT_LT(worst_step_m(truth[1], bad.T_world_sensor[1]), 0.03);
  EXPECT_LT(worst_step_m(truth[0], bad.T_world_sensor[0]), 0.03);
  EXPECT_LT(worst_meeting_m(truth, good), 0.06);
}

TEST(Slam, FrameDriftGrowsToTheAskedSize) {
  const auto truth = two_rings();
  const SlamResult result = solve(truth, {{.kind = FaultKind::kFrameDrift, .robot = 1, .at = 0.3, .size_m = 0.8}});
  EXPECT_NEAR(result.faults.at(0).size_m, 0.8, 0.03);
  EXPECT_LT(worst_step_m(truth[1], result.T_world_sensor[1]), 0.06);
}

TEST(Slam, WrongClosureBendsTheMapByAlmostItsSize) {
  const auto truth = two_rings();
  const SlamResult result = solve(truth, {{.kind = FaultKind::kWrongClosure, .at = 0.8, .size_m = 0.6}});
  EXPECT_NEAR(result.faults.at(0).size_m, 0.6, 0.1);
  EXPECT_GT(worst_meeting_m(truth, result), 0.3);
  EXPECT_LT(worst_step_m(truth[0], result.T_world_sensor[0]), 0.1) << "the bend is spread over the path";
}

TEST(Slam, MistakenPlacePutsTwoPlacesOnTopOfEachOther) {
  const auto truth = two_rings();
  const SlamResult result = solve(truth, {{.kind = FaultKind::kMistakenPlace, .at = 0.6, .size_m = 12.0}});
  const Fault& mistaken = result.faults.at(0);
  const Pose3 first = result.T_world_sensor[0][mistaken.against_scan];
  const Pose3 second = result.T_world_sensor[0][mistaken.scan];
  EXPECT_GT(distance_m(truth, {0, mistaken.scan}, {0, mistaken.against_scan}), 3.0);
  EXPECT_LT((first.inverse() * second).translation_m().norm(), 1.0);
  EXPECT_GT(mistaken.size_m, 3.0);
}

TEST(Slam, NoPlaceIsMistakenForItselfNorForOneMuchFartherOrNearerThanAsked) {
  const auto truth = two_rings();
  const auto refusal = [&](double at, double size_m) {
    const FaultRequest request{.kind = FaultKind::kMistakenPlace, .at = at, .size_m = size_m};
    const auto result = run_slam(truth, std::vector{request}, {}, 1);
    return result ? std::string() : result.error().message;
  };
  EXPECT_EQ(refusal(0.0, 5.0),
            "no room for the fault mistaken-place: robot a has seen no other place before its scan 0");
  for (const double size_m : {0.4, 100.0}) {
    EXPECT_NE(refusal(0.6, size_m).find("no place in the first half of robot a's way to its scan "), std::string::npos)
        << size_m;
  }
  EXPECT_EQ(refusal(0.6, 12.0), "");
}

TEST(Slam, SameSeedSamePosesAndAnotherSeedOthers) {
  const auto truth = two_rings();
  const auto last = [&](std::uint64_t seed) { return solve(truth, {}, seed).T_world_sensor[1].back().translation_m(); };
  EXPECT_EQ(last(4), last(4));
  EXPECT_NE(last(4), last(5));
}

TEST(Slam, RefusesFaultsWithoutRoom) {
  const auto truth = two_rings();
  const std::vector<RobotMotion> alone = {motion("a", {{0, 0, 0}, {30, 0, 0}})};
  const auto code = [](const auto& missions, const FaultRequest& request) {
    const auto result = run_slam(missions, std::vector{request}, {}, 1);
    return result ? ErrorCode::kInternal : result.error().code;
  };
  EXPECT_EQ(code(truth, {.kind = FaultKind::kSlip, .robot = 2}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(truth, {.kind = FaultKind::kFrameOffset, .robot = 0}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(alone, {.kind = FaultKind::kMissedClosure}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(alone, {.kind = FaultKind::kFrameDrift}), ErrorCode::kInvalidArgument);
}

TEST(Slam, FaultsThatTheMapCannotTakeAreNamedWithTheirSizes) {
  const auto truth = two_rings();
  const std::vector<FaultRequest> faults = {{.kind = FaultKind::kSlip, .robot = 1, .at = 0.5},
                                            {.kind = FaultKind::kWrongClosure, .size_m = 1000.0}};
  const auto result = run_slam(truth, faults, {}, 1);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().message.find("with the faults slip of 0.4 m (robot b), wrong-closure of 1000 m (robot a) "),
            0U)
      << result.error().message;
  EXPECT_EQ(result.error().hint, "plant smaller faults");
}

TEST(FaultKind, NamesReadBack) {
  for (int kind = 0; kind <= static_cast<int>(FaultKind::kMistakenPlace); ++kind) {
    EXPECT_EQ(fault_kind_from(to_string(static_cast<FaultKind>(kind))), static_cast<FaultKind>(kind));
  }
  EXPECT_FALSE(fault_kind_from("gremlins").has_value());
}

}  // namespace
}  // namespace kilter
