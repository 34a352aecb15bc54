// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/inspection.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

// Ten scans a metre apart along x, each with 1200 points between 1 and 13 m all around, and none of another scan's.
RobotLog robot(const std::string& name, double at_x_m = 0.0) {
  RobotLog log;
  log.name = name;
  log.kind = "robot folder";
  for (int i = 0; i < 10; ++i) log.T_world_cloud.push_back(Pose3::from_translation(at_x_m + i, 0.0, 0.0));
  log.clouds_found = log.poses_found = 10;
  log.read_cloud = [](std::size_t scan) -> Expected<PointCloud> {
    PointCloud cloud;
    Rng rng(1, scan);
    for (int i = 0; i < 1200; ++i) {
      const Eigen::Vector3d towards(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
      const Eigen::Vector3f at_m = ((1.0 + 0.01 * i) * towards.normalized()).cast<float>();
      cloud.add(at_m.x(), at_m.y(), at_m.z());
    }
    return cloud;
  };
  const auto own = static_cast<std::uint64_t>(1000.0 * at_x_m);
  log.peek_cloud = [own](std::size_t scan) -> std::optional<CloudPeek> { return CloudPeek{1200, 19200, own + scan}; };
  log.cloud_name = [](std::size_t scan) { return fmt::format("scan {}", scan); };
  return log;
}

Inspection inspected(std::vector<RobotLog> robots, const SubmapOptions& options = {}) {
  Mission mission;
  mission.robots = std::move(robots);
  auto inspection = inspect(mission, options);
  EXPECT_TRUE(inspection);
  return *std::move(inspection);
}

std::vector<std::string> codes(const Inspection& inspection) {
  std::vector<std::string> found;
  for (const Oddity& oddity : inspection.oddities) {
    found.emplace_back(oddity.code);
    EXPECT_FALSE(way_out_of(oddity.code).empty()) << oddity.code;
    EXPECT_FALSE(oddity.found.empty()) << oddity.code;
  }
  return found;
}

using Codes = std::vector<std::string>;

TEST(Inspect, CountsWithoutReadingEverything) {
  RobotLog log = robot("a");
  int reads = 0;
  const auto read = log.read_cloud;
  log.read_cloud = [&reads, read](std::size_t i) {
    ++reads;
    return read(i);
  };
  const Inspection inspection = inspected({std::move(log)});
  const RobotInspection& seen = inspection.robots.at(0);
  EXPECT_LE(reads, 13);
  EXPECT_EQ(seen.points->points, 12000U);
  EXPECT_FALSE(seen.points->estimated);
  EXPECT_DOUBLE_EQ(seen.path_length_m, 9.0);
  EXPECT_NEAR(*seen.median_range_m, 7.0, 0.1);
  EXPECT_EQ(inspection.likely_submaps, 1U);
  EXPECT_EQ(inspection.likely_pairs, 0U);
  EXPECT_EQ(codes(inspection), Codes{});
}

TEST(Inspect, SaysThatPointsOfCloudsNobodyLookedAtAreAnEstimate) {
  RobotLog log = robot("a");
  log.clouds_unread = 90;
  const Inspection inspection = inspected({std::move(log)});
  const RobotInspection& seen = inspection.robots.at(0);
  EXPECT_EQ(seen.clouds_unread, 90U);
  EXPECT_TRUE(seen.points->estimated);
  EXPECT_EQ(seen.points->points, 120'000U);
  EXPECT_DOUBLE_EQ(seen.path_length_m, 9.0);
  EXPECT_EQ(codes(inspection), Codes{});
}

TEST(Inspect, TakesNoBeginningForTheWholeWay) {
  // A robot that has not moved yet, and two that may still meet.
  RobotLog still = robot("a");
  for (Pose3& pose : still.T_world_cloud) pose = Pose3();
  still.clouds_unread = 90;
  EXPECT_EQ(codes(inspected({std::move(still), robot("b", 1000.0)})), Codes{});
}

TEST(Inspect, CountsTheVoxelsThatOctreesKnowToBeOccupied) {
  RobotLog log = robot("a");
  log.finished_submaps = true;
  log.peek_cloud = nullptr;
  log.read_cloud = nullptr;
  log.read_cells = [](std::size_t) -> Expected<OccupancyCells> {
    return OccupancyCells{0.1, {{{0, 0, 0}, 0, 0.8F}, {{1, 0, 0}, 0, -0.4F}, {{8, 8, 8}, 1, 0.0F}}};
  };
  const Inspection inspection = inspected({log});
  EXPECT_TRUE(inspection.robots[0].points_are_voxels);
  EXPECT_EQ(inspection.robots[0].points->points, 90U);
  EXPECT_FALSE(inspection.robots[0].points->estimated);
  log.read_cells = [](std::size_t) -> Expected<OccupancyCells> { return fail(ErrorCode::kTruncated, "short", "f"); };
  Mission mission;
  mission.robots.push_back(log);
  EXPECT_FALSE(inspect(mission, {}));
}

TEST(Inspect, EstimatesPointsOfVeryManyClouds) {
  RobotLog log = robot("a");
  log.T_world_cloud.resize(5000, log.T_world_cloud.back());
  const Inspection inspection = inspected({std::move(log)});
  EXPECT_TRUE(inspection.robots[0].points->estimated);
  EXPECT_EQ(inspection.robots[0].points->points, 5000U * 1200U);
}

// Forty poses round a square, always ahead.
RobotLog round_a_square(double step_m = 0.5) {
  RobotLog log = robot("a");
  log.T_world_cloud.clear();
  for (int i = 0; i < 40; ++i) {
    const double yaw = 0.5 * std::numbers::pi * (i / 10);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d at_m = i == 0 ? Eigen::Vector3d::Zero() : log.T_world_cloud.back().translation_m();
    log.T_world_cloud.emplace_back(turn, at_m + turn * Eigen::Vector3d(step_m, 0.0, 0.0));
  }
  log.clouds_found = log.poses_found = 40;
  return log;
}

TEST(Inspect, TellsWhatRotationsThatWereNotWrittenOrWrittenOtherwiseLookLike) {
  EXPECT_EQ(codes(inspected({round_a_square()})), Codes{});
  RobotLog unturned = round_a_square();
  for (Pose3& T : unturned.T_world_cloud) T = Pose3(Eigen::Quaterniond::Identity(), T.translation_m());
  EXPECT_EQ(codes(inspected({unturned})), Codes{"no-turns"});
  EXPECT_EQ(codes(inspected({robot("a")})), Codes{}) << "straight ahead nothing turns";
  RobotLog w_first = round_a_square();
  for (Pose3& T : w_first.T_world_cloud) {
    const Eigen::Quaterniond& q = T.rotation();
    T = Pose3(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), T.translation_m());
  }
  EXPECT_EQ(codes(inspected({w_first})), Codes{"tumbles"});
  RobotLog hanging = round_a_square();
  const Eigen::Quaterniond over(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  for (Pose3& T : hanging.T_world_cloud) T = Pose3(T.rotation() * over, T.translation_m());
  EXPECT_EQ(codes(inspected({hanging})), Codes{"upside-down"});
}

// Posts in a hall, of which a cloud shows those within 8 m, and the floor round the sensor.
TEST(Inspect, TellsPosesThatAreInvertedAndCloudsThatAreInTheWorldAlready) {
  RobotLog log = round_a_square(2.0);
  const std::vector<Pose3> truth = log.T_world_cloud;
  const auto posts_near = [&](std::size_t scan, const Pose3& T_cloud_world) {
    PointCloud cloud;
    Rng rng(7, 0);
    for (int post = 0; post < 400; ++post) {
      const Eigen::Vector3d foot_m(rng.uniform(-10.0, 30.0), rng.uniform(-10.0, 30.0), 0.0);
      if ((foot_m - truth[scan].translation_m()).norm() > 8.0) continue;
      for (int i = 0; i < 25; ++i) {
        const Eigen::Vector3f at_m = (T_cloud_world * (foot_m + Eigen::Vector3d(0.0, 0.0, 0.1 * i))).cast<float>();
        cloud.add(at_m.x(), at_m.y(), at_m.z());
      }
    }
    return cloud;
  };
  const auto with_ring = [](PointCloud cloud) {
    for (int i = 0; i < 700; ++i) {
      const float angle = 0.009F * static_cast<float>(i);
      cloud.add(4.0F * std::cos(angle), 4.0F * std::sin(angle), -1.0F);
    }
    return cloud;
  };
  log.read_cloud = [&](std::size_t i) -> Expected<PointCloud> { return with_ring(posts_near(i, truth[i].inverse())); };
  EXPECT_EQ(codes(inspected({log})), Codes{});
  for (Pose3& T : log.T_world_cloud) T = T.inverse();
  EXPECT_EQ(codes(inspected({log})), Codes{"inverse-poses"});
  // The vehicle's poses, whose sensor looks to its left.
  const Eigen::Quaterniond left(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ()));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    log.T_world_cloud[i] = Pose3(truth[i].rotation() * left, truth[i].translation_m());
  }
  EXPECT_EQ(codes(inspected({log})), Codes{"turned-sensor"});
  log.T_world_cloud = truth;
  log.read_cloud = [&](std::size_t i) -> Expected<PointCloud> { return posts_near(i, Pose3()); };
  EXPECT_EQ(codes(inspected({log})), Codes{"clouds-in-world"});
  log.finished_submaps = true;
  EXPECT_EQ(codes(inspected({log})), Codes{"clouds-in-world"});
  log.read_cloud = [&](std::size_t i) -> Expected<PointCloud> { return posts_near(i, truth[i].inverse()); };
  EXPECT_EQ(codes(inspected({log})), Codes{});
}

TEST(Inspect, TellsCloudsWhoseNamesAreOtherStampsThanTheirPoses) {
  RobotLog log = round_a_square();
  for (int i = 0; i < 40; ++i) log.stamps_ns.push_back(1'700'000'000'000'000'000 + 100'000'000LL * i);
  const auto named = [](std::function<int(int)> scan_of) {
    return [scan_of](std::size_t i) { return fmt::format("s/{:.1f}.pcd", 1.7e9 + 0.1 * scan_of(static_cast<int>(i))); };
  };
  log.cloud_name = named([](int i) { return i; });
  EXPECT_EQ(codes(inspected({log})), Codes{});
  log.cloud_name = named([](int i) { return i + 7; });
  EXPECT_EQ(codes(inspected({log})), Codes{}) << "another clock, the same clouds";
  log.cloud_name = named([](int i) { return i + 40; });
  EXPECT_EQ(codes(inspected({log})), Codes{"other-clock"}) << "without a time in common";
  log.cloud_name = named([](int i) { return i < 5 ? i : i + 1; });
  EXPECT_EQ(codes(inspected({log})), Codes{"stamps-differ"});
  log.cloud_name = [](std::size_t i) { return fmt::format("{:06}.pcd", 2 * i); };
  EXPECT_EQ(codes(inspected({log})), Codes{}) << "numbers are no stamps";
  log.pose_stamps_ns = log.stamps_ns;
  EXPECT_EQ(codes(inspected({log})), Codes{});
  std::reverse(log.pose_stamps_ns.begin(), log.pose_stamps_ns.end());
  EXPECT_EQ(codes(inspected({log})), Codes{"stamps-differ"}) << "poses in the place of the source's own";
}

TEST(Inspect, CountsPairsOfSubmapsThatAreNear) {
  EXPECT_EQ(inspected({robot("a"), robot("b", 15.0)}).likely_pairs, 1U);
  EXPECT_EQ(inspected({robot("a"), robot("b", 50.0)}).likely_pairs, 0U);
}

TEST(Inspect, PairsAreNearAsFarAsCloudsReach) {
  EXPECT_EQ(inspected({robot("a"), robot("b", 30.0)}).likely_pairs, 1U) << "21 m apart, and 12 m are seen from both";
  SubmapOptions options;
  options.occupancy.max_range_m = 10.0;
  EXPECT_EQ(inspected({robot("a"), robot("b", 30.0)}, options).likely_pairs, 0U);
  RobotLog finished = robot("a");
  finished.finished_submaps = true;
  for (std::size_t i = 0; i < 10; ++i) {
    finished.T_world_cloud[i] = Pose3::from_translation(20.0 * static_cast<double>(i), 0.0, 0.0);
  }
  EXPECT_EQ(inspected({finished}, options).likely_pairs, 9U) << "ranges are those of scans";
  finished.read_cloud = nullptr;
  finished.peek_cloud = nullptr;
  finished.read_cells = [](std::size_t) -> Expected<OccupancyCells> {
    OccupancyCells known;
    known.resolution_m = 1.0;
    for (std::int16_t x = 0; x < 100; ++x) {
      known.cells.push_back({{x, 0, 0}, 0, x < 25 ? 1.0F : -1.0F});
    }
    return known;
  };
  EXPECT_EQ(inspected({finished}).likely_pairs, 9U + 8U) << "24 m each, and nothing is said of free space";
}

TEST(FindOddities, SeesPosesOfACamera) {
  RobotLog log = robot("a");
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));  // z ahead
  for (Pose3& pose : log.T_world_cloud) pose = Pose3(turned, pose.translation_m());
  EXPECT_EQ(codes(inspected({std::move(log)})), Codes{"camera-frame"});
}

TEST(FindOddities, SeesMillimetres) {
  RobotLog poses = robot("a");
  for (Pose3& pose : poses.T_world_cloud) pose = Pose3(pose.rotation(), 1000.0 * pose.translation_m());
  EXPECT_EQ(codes(inspected({std::move(poses)})), Codes{"millimetres"});
  RobotLog clouds = robot("a");
  clouds.read_cloud = [](std::size_t) -> Expected<PointCloud> {
    PointCloud cloud;
    for (int i = 0; i < 2000; ++i) cloud.add(10.0F * static_cast<float>(i), 0.0F, 0.0F);
    return cloud;
  };
  EXPECT_EQ(codes(inspected({std::move(clouds)})), Codes{"millimetres"});
}

TEST(FindOddities, SeesTheSameCloudTwice) {
  RobotLog log = robot("a");
  const auto read = log.read_cloud;
  log.read_cloud = [read](std::size_t i) { return read(i == 5 ? 4 : i); };
  EXPECT_EQ(codes(inspected({log})), Codes{});  // sizes and heads differ: not read at all
  log.peek_cloud = [](std::size_t) -> std::optional<CloudPeek> { return CloudPeek{1200, 19200, 0}; };
  const Inspection inspection = inspected({std::move(log)});
  ASSERT_EQ(codes(inspection), Codes{"identical-clouds"});
  EXPECT_EQ(inspection.oddities[0].found, "scan 4 and scan 5");
}

TEST(FindOddities, SeesCloudsThatAreCutShort) {
  RobotLog log = robot("a");
  log.peek_cloud = [](std::size_t scan) -> std::optional<CloudPeek> {
    return CloudPeek{1200, 19200, scan, scan == 3 || scan == 7};
  };
  const Inspection inspection = inspected({std::move(log)});
  ASSERT_EQ(codes(inspection), Codes{"damaged-clouds"});
  EXPECT_EQ(inspection.oddities[0].found, "2 of 10 files, the first is scan 3");
}

TEST(FindOddities, SeesCloudsThatCannotBeOpened) {
  RobotLog log = robot("a");
  log.peek_cloud = [](std::size_t scan) {
    return scan == 4 ? std::nullopt : std::optional(CloudPeek{1200, 19200, scan, scan == 8});
  };
  const Inspection inspection = inspected({std::move(log)});
  ASSERT_EQ(codes(inspection), (Codes{"unreadable-clouds", "damaged-clouds"}));
  EXPECT_EQ(inspection.oddities[0].found, "1 of 10 files, the first is scan 4");
}

TEST(FindOddities, SeesTimeThatJumps) {
  RobotLog log = robot("a");
  for (std::int64_t i = 0; i < 10; ++i) log.stamps_ns.push_back(i * 100'000'000);
  EXPECT_EQ(codes(inspected({log})), Codes{});
  RobotLog back = log;
  std::swap(back.stamps_ns[3], back.stamps_ns[4]);
  EXPECT_EQ(codes(inspected({back})), Codes{"time-jump"});
  std::swap(back.stamps_ns[0], back.stamps_ns[9]);
  const Inspection unordered = inspected({std::move(back)});
  ASSERT_EQ(codes(unordered), Codes{"time-jump"});
  EXPECT_EQ(unordered.oddities[0].found, "0.8 s back between clouds 0 and 1, and 2 times more");
  EXPECT_EQ(*unordered.robots[0].first_ns, 0);
  EXPECT_EQ(*unordered.robots[0].last_ns, 900'000'000);
  log.stamps_ns.back() += 3'600'000'000'000;
  EXPECT_EQ(codes(inspected({log})), Codes{"time-jump"});
  log.stamps_ns.assign(10, 1'700'000'000'000'000'000);
  const Inspection equal = inspected({std::move(log)});
  ASSERT_EQ(codes(equal), Codes{"equal-stamps"});
  EXPECT_EQ(equal.oddities[0].found, "all 10 are 1700000000.000 s");
}

TEST(FindOddities, SeesPosesThatJumpOrStand) {
  RobotLog jump = robot("a");
  for (std::size_t i = 6; i < 10; ++i)
    jump.T_world_cloud[i] = Pose3::from_translation(40.0 + static_cast<double>(i), 0, 0);
  const Inspection inspection = inspected({std::move(jump)});
  ASSERT_EQ(codes(inspection), Codes{"pose-jump"});
  EXPECT_EQ(inspection.oddities[0].found, "41.0 m between clouds 5 and 6, usually 1.00 m");
  RobotLog still = robot("a");
  for (Pose3& pose : still.T_world_cloud) pose = Pose3();
  EXPECT_EQ(codes(inspected({std::move(still)})), Codes{"no-motion"});
}

TEST(FindOddities, SeesARobotFarFromAllOthersAndOneNamedTwice) {
  EXPECT_EQ(codes(inspected({robot("a"), robot("b", 5.0), robot("c", 1000.0)})), Codes{"far-robot"});
  const Inspection twice = inspected({robot("a"), robot("b")});
  EXPECT_EQ(codes(twice), Codes{"identical-robots"});
  EXPECT_EQ(twice.oddities[0].found, "its poses and clouds are those of a");
  RobotLog elsewhere = robot("b");
  for (Pose3& pose : elsewhere.T_world_cloud) pose = Pose3::from_translation(0.3, 0.0, 0.0) * pose;
  const Inspection moved = inspected({robot("a"), std::move(elsewhere)});
  EXPECT_EQ(codes(moved), Codes{"identical-robots"});
  EXPECT_EQ(moved.oddities[0].found, "its clouds are those of a, under other poses");
}

TEST(FindOddities, SeesCloudsWithoutPosesAndPoorClouds) {
  RobotLog unmatched = robot("a");
  unmatched.clouds_found = 12;
  EXPECT_EQ(codes(inspected({std::move(unmatched)})), Codes{"poses-unmatched"});
  RobotLog poor = robot("a");
  poor.read_cloud = [](std::size_t) -> Expected<PointCloud> {
    PointCloud cloud;
    for (int i = 0; i < 800; ++i) cloud.add(1.0F + 0.01F * static_cast<float>(i), 0.0F, 0.0F);
    for (int i = 0; i < 100; ++i) cloud.add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
    return cloud;
  };
  EXPECT_EQ(codes(inspected({std::move(poor)})), (Codes{"dropped-points", "few-points"}));
}

TEST(FindOddities, TakesNoPointsThatAreNoneForMillimetres) {
  RobotLog log = robot("a");
  const auto read = log.read_cloud;
  for (const float x : {std::numeric_limits<float>::quiet_NaN(), 691'000.0F}) {
    log.read_cloud = [read, x](std::size_t i) -> Expected<PointCloud> {
      if (i > 0) return read(i);
      PointCloud cloud;
      for (int k = 0; k < 2000; ++k) cloud.add(x, 0.0F, 0.0F);
      return cloud;
    };
    EXPECT_EQ(codes(inspected({log})), (Codes{"dropped-points", "few-points"}));
  }
}

TEST(Inspect, RefusesARobotWithoutAPointThatCanBeUsed) {
  Mission mission;
  mission.robots.push_back(robot("a"));
  mission.robots[0].read_cloud = [](std::size_t) -> Expected<PointCloud> { return PointCloud{{}, 5, 0}; };
  const auto inspection = inspect(mission, {});
  ASSERT_FALSE(inspection);
  EXPECT_EQ(inspection.error().code, ErrorCode::kInvalidPoints);
  EXPECT_EQ(inspection.error().where, "scan 0");
}

TEST(Inspect, PassesOnWhatIsWrongWithTheFirstCloud) {
  Mission mission;
  mission.robots.push_back(robot("a"));
  mission.robots[0].read_cloud = [](std::size_t) -> Expected<PointCloud> {
    return fail(ErrorCode::kTruncated, "short", "f");
  };
  const auto inspection = inspect(mission, {});
  ASSERT_FALSE(inspection);
  EXPECT_EQ(inspection.error().code, ErrorCode::kTruncated);
}

}  // namespace
}  // namespace kilter
