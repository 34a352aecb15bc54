// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numbers>

#include "kilter/simulation/closures.h"
#include "kilter/simulation/simulated_mission.h"

namespace kilter {
namespace {

LidarModel coarse_lidar() {
  LidarModel model;
  model.columns = 360;
  return model;
}

SimulatedMission mission_of(std::string_view name, const SceneOptions& options) {
  Expected<Scene> scene = make_scene(name, options);
  EXPECT_TRUE(scene.has_value());
  Expected<SimulatedMission> mission = SimulatedMission::plan(std::move(*scene), coarse_lidar(), options.seed);
  EXPECT_TRUE(mission.has_value()) << name << " seed " << options.seed << ": "
                                   << (mission ? "" : mission.error().message);
  return std::move(*mission);
}

bool same_bytes(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Eigen::Vector3f)) == 0;
}

void expect_free_way(const RayCaster& world, const RobotRoute& route, std::uint64_t seed) {
  const Trajectory drive = Trajectory::along(route.corners_m, route.drive);
  const RayCaster::Moment moment = world.at(0.0);
  for (double t = 0.0; t < drive.duration_s(); t += 0.5) {
    const Eigen::Vector3d eye = drive.at(t).translation_m();
    for (int i = 0; i < 16; ++i) {
      const double angle = 0.3927 * i;
      const auto hit = moment.first_hit(eye, {std::cos(angle), std::sin(angle), 0.0}, 0.3);
      ASSERT_FALSE(hit.has_value()) << "within 0.3 m of " << eye.transpose() << ", seed " << seed;
    }
    const auto floor = moment.first_hit(eye, -Eigen::Vector3d::UnitZ(), 5.0);
    ASSERT_TRUE(floor.has_value()) << "no ground below " << eye.transpose() << ", seed " << seed;
    ASSERT_NEAR(floor->range_m, route.drive.sensor_height_m, 0.4) << eye.transpose() << ", seed " << seed;
  }
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, PlansForTenSeedsWithScansLikeALidars) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const SimulatedMission mission = mission_of(GetParam(), {.seed = seed});
    ASSERT_EQ(mission.robots().size(), 2U);
    for (std::size_t r = 0; r < 2; ++r) {
      const SimulatedRobot& robot = mission.robots()[r];
      ASSERT_GT(robot.stamp_s.size(), 40U) << robot.name;
      ASSERT_EQ(robot.T_world_sensor.size(), robot.stamp_s.size());
      const SimulatedScan scan = mission.scan(r, robot.stamp_s.size() / 2);
      const auto beams = static_cast<double>(16 * 360);
      EXPECT_GT(static_cast<double>(scan.cloud.points_m.size()), 0.35 * beams) << "seed " << seed;
    }
  }
}

TEST_P(EveryScene, RobotsNeverTouchWhatStandsStill) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scene scene = *make_scene(GetParam(), {.seed = seed});
    const RayCaster world = *RayCaster::build({scene.world.fixed, {}});
    for (const RobotRoute& route : scene.routes) expect_free_way(world, route, seed);
  }
}

TEST_P(EveryScene, SameSeedSameScanAndAnotherSeedAnother) {
  const auto scan = [](std::uint64_t seed) { return mission_of(GetParam(), {.seed = seed}).scan(1, 7).cloud.points_m; };
  const auto first = scan(5);
  EXPECT_TRUE(same_bytes(first, scan(5)));
  EXPECT_FALSE(same_bytes(first, scan(6)));
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_catalog()) names.emplace_back(info.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Catalog, EveryScene, testing::ValuesIn(scene_names()), [](const auto& test) {
  std::string name = test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Scene, TakesFiveRobotsAndGrowsWithScale) {
  for (const std::string name :
       {"office", "carpark", "warehouse", "tunnel", "stairs", "forest", "village", "factory"}) {
    EXPECT_EQ(mission_of(name, {.robots = 5}).robots().size(), 5U) << name;
    EXPECT_EQ(mission_of(name, {.robots = 1}).robots().size(), 1U) << name;
    const auto length_m = [&](double scale) {
      const Scene scene = *make_scene(name, {.scale = scale});
      return Trajectory::along(scene.routes[1].corners_m, scene.routes[1].drive).length_m();
    };
    EXPECT_GT(length_m(3.0), 1.1 * length_m(1.0)) << name;
  }
}

TEST(Scene, HasRoomForItsOwnFaultsAtEveryScale) {
  for (const std::string name : {"office", "carpark", "warehouse", "forest", "village", "factory"}) {
    for (const double scale : {0.5, 1.25, 2.0, 4.0}) {
      for (const std::uint64_t seed : {1, 3}) {
        const SceneOptions options{.seed = seed, .scale = scale, .robots = seed == 3 ? 5 : 2};
        EXPECT_EQ(mission_of(name, options).robots().size(), seed == 3 ? 5U : 2U) << "scale " << scale;
      }
    }
  }
}

TEST(Scene, ThePapersHaveTheirOwnSizeAndTwoRobots) {
  for (const std::string name : {"paper-indoor", "paper-outdoor"}) {
    for (const SceneOptions& options : {SceneOptions{.scale = 2.0}, SceneOptions{.robots = 3}}) {
      const Expected<Scene> scene = make_scene(name, options);
      ASSERT_FALSE(scene.has_value()) << name;
      EXPECT_EQ(scene.error().code, ErrorCode::kInvalidArgument);
      EXPECT_EQ(scene.error().message.find(name + " has its own size and two robots"), 0U) << scene.error().message;
    }
    EXPECT_TRUE(make_scene(name, {.scale = 1.0, .robots = 2}).has_value()) << name;
  }
}

TEST(Scene, CorridorsOfALargeOfficeAreFree) {
  for (const double scale : {1.5, 3.0}) {
    const Scene scene = *make_scene("office", {.seed = 1, .scale = scale, .robots = 5});
    const RayCaster world = *RayCaster::build({scene.world.fixed, {}});
    for (const RobotRoute& route : scene.routes) expect_free_way(world, route, 1);
  }
}

TEST(Scene, StoreysOfTheStairsOverlapInPlanOnly) {
  const SimulatedMission mission = mission_of("stairs", {});
  double low = 1e9;
  double high = -1e9;
  for (const Pose3& T : mission.robots()[0].T_world_sensor_true) {
    low = std::min(low, T.translation_m().z());
    high = std::max(high, T.translation_m().z());
  }
  EXPECT_NEAR(high - low, 3.2, 0.1);
}

TEST(Scene, CleanMissionsHaveNoFaultsAndResidualsOfCentimetres) {
  // How far away the walls are that show a turn.
  for (const auto& [name, wall_m] : std::map<std::string, double>{{"clean-office", 4.0}, {"clean-carpark", 12.0}}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const SimulatedMission mission = mission_of(name, {.seed = seed, .scale = seed % 2 == 0 ? 0.5 : 1.0});
      EXPECT_TRUE(mission.faults().empty());
      std::vector<RobotMotion> truth;
      for (const SimulatedRobot& robot : mission.robots()) {
        truth.push_back({robot.name, robot.T_world_sensor_true, robot.stamp_s});
      }
      double squares = 0.0;
      double largest_m = 0.0;
      // Wherever both look at the same walls, not only where they drive through the same place.
      const auto meetings = find_meetings(truth, {.closure_distance_m = 1.5 * wall_m, .closure_spacing_m = 1.0});
      for (const Meeting& meeting : meetings) {
        const auto pose = [&](const ScanRef& ref, bool is_true) {
          const SimulatedRobot& robot = mission.robots()[ref.robot];
          return (is_true ? robot.T_world_sensor_true : robot.T_world_sensor)[ref.scan];
        };
        const Vector6 error = relative_error(pose(meeting.earlier, true), pose(meeting.later, true),
                                             pose(meeting.earlier, false), pose(meeting.later, false));
        squares += error.head<3>().squaredNorm();
        largest_m = std::max(largest_m, error.head<3>().norm() + wall_m * error.tail<3>().norm());
      }
      const double rms_m = std::sqrt(squares / static_cast<double>(meetings.size()));
      EXPECT_GT(rms_m, 0.01) << name << seed;
      EXPECT_LT(rms_m, 0.05) << name << seed;
      EXPECT_LT(largest_m, 0.08) << name << seed;
    }
  }
}

// The scans that begin a submap: after 10 m of path or half a turn, as the paper's experiments are cut.
std::vector<std::size_t> cuts_of(const std::vector<Pose3>& poses) {
  std::vector<std::size_t> cuts = {0};
  double path_m = 0.0;
  double turned_rad = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose3 step = poses[i - 1].inverse() * poses[i];
    path_m += step.translation_m().norm();
    turned_rad += step.angle_rad();
    if (path_m < 10.0 && turned_rad < std::numbers::pi) continue;
    cuts.push_back(i);
    path_m = turned_rad = 0.0;
  }
  return cuts;
}

TEST(Scene, ThePapersSubmapsBeginAtTheSameScansInEverySeed) {
  for (const std::string name : {"paper-indoor", "paper-outdoor"}) {
    const SimulatedMission first = mission_of(name, {.seed = 1});
    for (std::uint64_t seed = 2; seed <= 20; ++seed) {
      const SimulatedMission mission = mission_of(name, {.seed = seed});
      for (std::size_t r = 0; r < 2; ++r) {
        EXPECT_EQ(cuts_of(mission.robots()[r].T_world_sensor), cuts_of(first.robots()[r].T_world_sensor))
            << name << ", seed " << seed << ", robot " << mission.robots()[r].name;
      }
    }
  }
}

TEST(Scene, RefusesWhatIsNotThere) {
  const auto unknown = make_scene("ofice", {});
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(unknown.error().hint, "did you mean office?");
  EXPECT_FALSE(make_scene("office", {.scale = 0.0}).has_value());
  EXPECT_FALSE(make_scene("office", {.robots = 6}).has_value());
}

TEST(SimulatedMission, ScansAreTheSameForAnyNumberOfThreads) {
  const SimulatedMission mission = mission_of("carpark", {.seed = 2});
  const auto points = [&](int threads) {
    std::vector<Eigen::Vector3f> all;
    std::size_t next = 0;
    const auto done = for_each_scan(mission, 0, {.threads = threads}, [&](std::size_t i, const SimulatedScan& scan) {
      EXPECT_EQ(i, next++);
      all.insert(all.end(), scan.cloud.points_m.begin(), scan.cloud.points_m.end());
      return Expected<void>{};
    });
    EXPECT_TRUE(done.has_value());
    return all;
  };
  EXPECT_TRUE(same_bytes(points(1), points(2)));
}

TEST(SimulatedMission, StopsWhenAskedAndWhenTheTakerFails) {
  const SimulatedMission mission = mission_of("tunnel", {});
  const std::atomic<bool> cancelled = true;
  const auto stopped = for_each_scan(mission, 0, {.threads = 1, .cancelled = &cancelled},
                                     [](std::size_t, const SimulatedScan&) { return Expected<void>{}; });
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  const auto full = for_each_scan(mission, 0, {}, [](std::size_t, const SimulatedScan&) -> Expected<void> {
    return fail(ErrorCode::kNoSpace, "full");
  });
  EXPECT_EQ(full.error().code, ErrorCode::kNoSpace);
}

}  // namespace
}  // namespace kilter
