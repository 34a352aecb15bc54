// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/check.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "testing/memory_spill.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::furnished_room;
using testing::MemorySpill;
using testing::robot_log;
using testing::Scene;

std::vector<Pose3> loop_through_room(double start_x) {
  std::vector<Pose3> poses;
  for (int i = 0; i < 8; ++i) {
    const double yaw = 0.15 * i;
    poses.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
                       Eigen::Vector3d(start_x + 0.7 * i, 2.03 + 0.25 * i, 1.02));
  }
  return poses;
}

std::vector<Pose3> moved(std::vector<Pose3> poses, const Pose3& by) {
  for (Pose3& pose : poses) pose = by * pose;
  return poses;
}

CheckOptions small_submaps() {
  CheckOptions options;
  options.submap.cutting.submap_distance_m = 2.0;
  return options;
}

std::vector<RobotLog> two_robots(const Pose3& error_of_b) {
  const auto a = loop_through_room(2.01);
  const auto b = loop_through_room(3.52);
  return {robot_log("a", furnished_room(), a, a, 1), robot_log("b", furnished_room(), b, moved(b, error_of_b), 2)};
}

TEST(Check, AgreeingRobotsMakeAConsistentMap) {
  const auto result = check(two_robots({}), small_submaps(), {}, {.threads = 2});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->system.state, MapState::kConsistent) << result->system.reason;
  EXPECT_EQ(result->system.inconsistent, 0U);
  EXPECT_LT(*result->system.certificate_m, 0.1);
  EXPECT_EQ(result->robots.size(), 2U);
  for (const PairResult& pair : result->pairs) {
    EXPECT_LT(pair.id.target, pair.id.source);
    EXPECT_LT(pair.verdict.offset_m.value_or(0.0), 0.04) << pair.verdict.reason;
  }
}

TEST(Check, AScanThatCannotBeReadEndsItBeforeFurtherSubmapsAreBegun) {
  std::vector<RobotLog> robots = two_robots({});
  int reads = 0;
  for (RobotLog& robot : robots) {
    robot.read_cloud = [&reads, read = robot.read_cloud](std::size_t scan) -> Expected<PointCloud> {
      ++reads;
      if (scan == 1) return fail(ErrorCode::kParse, "broken");
      return read(scan);
    };
  }
  const auto result = check(robots, small_submaps(), {}, {.threads = 1});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "broken");
  EXPECT_EQ(reads, 2);
}

TEST(Check, ADisplacedRobotIsFoundWithItsOffset) {
  const auto result = check(two_robots(Pose3::from_translation(0.0, 0.25, 0.0)), small_submaps(), {}, {.threads = 2});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->system.state, MapState::kInconsistent);
  for (const PairResult& pair : result->pairs) {
    if (pair.kind != PairKind::kGlobal) {
      EXPECT_NE(pair.verdict.verdict, Verdict::kInconsistent);
    } else {
      EXPECT_EQ(pair.verdict.verdict, Verdict::kInconsistent) << pair.verdict.reason;
      EXPECT_NEAR(pair.verdict.offset_m.value_or(0.0), 0.25, 0.02);
    }
  }
}

// Walls, floor and ceiling fit wherever the other robot is along them; poles and a few pieces of furniture do not.
TEST(Check, AShiftThatOnlyPolesAndFurnitureCarryIsFound) {
  Scene scene = testing::bare_corridor();
  for (const double x : {-9.1, -6.3, -3.4, -1.2, 1.7, 3.9, 6.8, 9.6}) {
    const double y = x < 0.0 ? 1.1 : -1.2;
    scene.push_back({{x, y, 0.0}, {x + 0.12, y + 0.12, 2.5}});
  }
  scene.push_back({{-4.6, -1.5, 0.4}, {-3.2, -1.05, 0.45}});  // a bench
  scene.push_back({{4.6, 1.1, 0.0}, {5.3, 1.5, 0.9}});        // a bin
  const auto a = testing::straight_path({-3.0, 0.1, 1.0}, {1.0, 0.0, 0.0}, 12, 0.5);
  const auto b = testing::straight_path({-2.3, -0.2, 1.1}, {1.0, 0.0, 0.0}, 12, 0.5);
  for (const double shift_m : {0.0, 0.3}) {
    const auto believed = moved(b, Pose3::from_translation(shift_m, 0.0, 0.0));
    const auto result = check({robot_log("a", scene, a, a, 1), robot_log("b", scene, b, believed, 2)}, small_submaps(),
                              {}, {.threads = 2});
    ASSERT_TRUE(result.has_value());
    std::size_t found = 0;
    for (const PairResult& pair : result->pairs) {
      if (shift_m == 0.0 || pair.kind != PairKind::kGlobal) {
        EXPECT_NE(pair.verdict.verdict, Verdict::kInconsistent) << pair.verdict.reason;
        continue;
      }
      EXPECT_NE(pair.verdict.verdict, Verdict::kConsistent) << pair.verdict.reason;
      if (pair.verdict.verdict != Verdict::kInconsistent) continue;
      ++found;
      EXPECT_NEAR(pair.verdict.offset_m.value_or(0.0), shift_m, 0.03);
    }
    EXPECT_EQ(found, shift_m > 0.0 ? 9U : 0U) << "all pairs between the robots";
  }
}

TEST(Check, RobotsThatNeverMeetAreUndetermined) {
  const auto a = loop_through_room(2.01);
  const std::vector<RobotLog> robots = {
      robot_log("a", furnished_room(), a, a, 1),
      robot_log("b", furnished_room(), a, moved(a, Pose3::from_translation(500.0, 0.0, 0.0)), 2)};
  const auto result = check(robots, small_submaps(), {}, {.threads = 2});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->system.state, MapState::kUndetermined);
  EXPECT_EQ(result->system.reason, "robots a and b never meet");
}

// Two robots' submaps pushed apart step by step: never called consistent once they are off.
TEST(Check, APairPushedApartIsNeverConsistent) {
  for (const double shift_m : {0.5, 1.5, 4.0, 9.0, 13.0}) {
    const auto result =
        check(two_robots(Pose3::from_translation(shift_m, 0.0, 0.0)), small_submaps(), {}, {.threads = 2});
    ASSERT_TRUE(result.has_value());
    EXPECT_NE(result->system.state, MapState::kConsistent) << shift_m;
    for (const PairResult& pair : result->pairs) {
      if (pair.kind == PairKind::kGlobal) {
        EXPECT_NE(pair.verdict.verdict, Verdict::kConsistent) << shift_m << " " << pair.verdict.reason;
      }
    }
  }
}

// To the bit.
void expect_same(const PairResult& a, const PairResult& b) {
  SCOPED_TRACE(fmt::format("{} {}", a.id.source.value, a.id.target.value));
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.verdict.reason, b.verdict.reason);
  EXPECT_EQ(a.verdict.offset_m, b.verdict.offset_m);
  EXPECT_EQ(a.verdict.offset_interval_m, b.verdict.offset_interval_m);
  EXPECT_EQ(a.verdict.p_value, b.verdict.p_value);
  EXPECT_EQ(a.verdict.p_inconsistent, b.verdict.p_inconsistent);
  ASSERT_EQ(a.verdict.evidence.size(), b.verdict.evidence.size());
  for (const auto& [name, of_a] : a.verdict.evidence) {
    const auto of_b = b.verdict.evidence.find(name);
    ASSERT_NE(of_b, b.verdict.evidence.end()) << name;
    EXPECT_EQ(of_a.value, of_b->second.value) << name;
    EXPECT_EQ(of_a.null, of_b->second.null) << name;
    EXPECT_EQ(of_a.log_ratio, of_b->second.log_ratio) << name;
  }
  EXPECT_EQ(a.verified, b.verified);
  ASSERT_TRUE(a.covariance.has_value());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Check, ThreadsChangeNothing) {
  const auto one = check(two_robots(Pose3::from_translation(0.1, 0.1, 0.0)), small_submaps(), {}, {.threads = 1});
  const auto three = check(two_robots(Pose3::from_translation(0.1, 0.1, 0.0)), small_submaps(), {}, {.threads = 3});
  ASSERT_TRUE(one.has_value());
  ASSERT_TRUE(three.has_value());
  EXPECT_EQ(one->system.reason, three->system.reason);
  EXPECT_EQ(one->system.certificate_m, three->system.certificate_m);
  EXPECT_EQ(one->cycles.covariance_scale, three->cycles.covariance_scale);
  ASSERT_FALSE(one->pairs.empty());
  ASSERT_EQ(one->pairs.size(), three->pairs.size());
  for (std::size_t i = 0; i < one->pairs.size(); ++i) expect_same(one->pairs[i], three->pairs[i]);
}

TEST(Check, SwappingRobotNamesTransposesPairsAndKeepsVerdicts) {
  auto robots = two_robots(Pose3::from_translation(0.0, 0.25, 0.0));
  const auto forward = check(robots, small_submaps(), {}, {.threads = 2});
  std::swap(robots[0], robots[1]);
  std::swap(robots[0].name, robots[1].name);
  const auto backward = check(robots, small_submaps(), {}, {.threads = 2});
  EXPECT_EQ(forward->system.state, backward->system.state);
  ASSERT_EQ(forward->pairs.size(), backward->pairs.size());
  const int n = 3;  // submaps of each robot
  for (const PairResult& pair : forward->pairs) {
    if (pair.kind != PairKind::kGlobal) continue;
    // The robots changed places: what was source (b/i) is target now.
    const PairId swapped{{pair.id.target.value + n}, {pair.id.source.value - n}};
    const auto other = std::find_if(backward->pairs.begin(), backward->pairs.end(),
                                    [&](const PairResult& candidate) { return candidate.id == swapped; });
    ASSERT_NE(other, backward->pairs.end());
    EXPECT_EQ(pair.verdict.verdict, other->verdict.verdict) << pair.verdict.reason << " / " << other->verdict.reason;
    EXPECT_NEAR(*pair.verdict.offset_m, *other->verdict.offset_m, 0.005);
    EXPECT_EQ(pair.score.has_value(), other->score.has_value());
  }
}

TEST(Check, TheSeedPresetRunsThePaperAlone) {
  CheckOptions options = small_submaps();
  apply_seed_preset(options);
  const auto result = check(two_robots({}), options, {}, {.threads = 2});
  ASSERT_TRUE(result.has_value());
  int with_theta = 0;
  for (const PairResult& pair : result->pairs) {
    if (!pair.score) continue;
    EXPECT_EQ(pair.score->gamma_per_m3, pair.score->gamma_literal_per_m3);
    if (pair.registered_score) {
      EXPECT_EQ(pair.theta_oicp_per_m3, pair.registered_score->gamma_per_m3);
      EXPECT_NEAR(*pair.verified, *pair.theta_oicp_per_m3 - *pair.score->gamma_per_m3, 1e-9);
      ++with_theta;
    }
  }
  EXPECT_GT(with_theta, 0);
}

TEST(Check, MapsAreFusedWhenAskedFor) {
  const auto result = check(two_robots({}), small_submaps(), {}, {.threads = 2, .fuse_maps = true});
  ASSERT_EQ(result->maps.size(), 3U);
  EXPECT_EQ(result->maps[2].name, "global");
  EXPECT_GE(result->maps[2].voxels.size(), result->maps[0].voxels.size());
}

// Room for little more than one pair of the six submaps.
TEST(Check, AnyBudgetGivesTheSameResult) {
  const auto robots = two_robots(Pose3::from_translation(0.1, 0.1, 0.0));
  const auto all = check(robots, small_submaps(), {}, {.threads = 2, .fuse_maps = true, .draw_picture = true});
  ASSERT_TRUE(all.has_value());
  std::size_t largest = 0;
  for (const SubmapSummary& submap : all->submaps) largest = std::max(largest, submap.bytes);
  MemorySpill spill;
  const auto few =
      check(robots, small_submaps(), {},
            {.threads = 3, .memory_bytes = 4 * largest, .spill = &spill, .fuse_maps = true, .draw_picture = true});
  ASSERT_TRUE(few.has_value()) << few.error().message;
  EXPECT_GT(spill.written(), 2U);
  EXPECT_GT(spill.reads(), spill.written());
  ASSERT_EQ(few->pairs.size(), all->pairs.size());
  for (std::size_t i = 0; i < all->pairs.size(); ++i) {
    EXPECT_EQ(few->pairs[i].verdict.offset_m, all->pairs[i].verdict.offset_m);
    EXPECT_EQ(few->pairs[i].verdict.log_odds, all->pairs[i].verdict.log_odds);
    EXPECT_EQ(few->pairs[i].verified, all->pairs[i].verified);
    EXPECT_EQ(few->picture->pairs[i].source.after, all->picture->pairs[i].source.after);
  }
  for (std::size_t i = 0; i < all->submaps.size(); ++i) {
    EXPECT_EQ(few->picture->clouds[i].points, all->picture->clouds[i].points);
  }
  ASSERT_EQ(few->maps[2].voxels.size(), all->maps[2].voxels.size());
  for (std::size_t i = 0; i < all->maps[2].voxels.size(); ++i) {
    EXPECT_EQ(few->maps[2].voxels[i].log_odds, all->maps[2].voxels[i].log_odds);
    EXPECT_EQ(few->maps[2].voxels[i].centroid_world_m, all->maps[2].voxels[i].centroid_world_m);
  }
}

TEST(Check, MemoryBudgetAndCancellationEndTheRun) {
  EXPECT_EQ(check(two_robots({}), small_submaps(), {}, {.memory_bytes = 1000}).error().code, ErrorCode::kOutOfMemory);
  const std::atomic<bool> cancelled = true;
  EXPECT_EQ(check(two_robots({}), small_submaps(), {}, {.cancelled = &cancelled}).error().code, ErrorCode::kCancelled);
}

TEST(Check, RefusesASearchFartherThanMemoryAllowsAndOneWithinAVoxel) {
  CheckOptions options;
  options.matching.max_distance_m = 0.1;
  EXPECT_TRUE(validate(options));
  options.matching.max_distance_m = 0.09;
  EXPECT_FALSE(validate(options));
  options.matching.max_distance_m = 20.0;
  EXPECT_TRUE(validate(options));
  options.matching.max_distance_m = 21.0;
  const auto result = check({}, options, {}, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kConfig);
  EXPECT_EQ(result.error().message.substr(0, 3), "d: ");
}

TEST(CheckOptions, HoldEveryKeyOnce) {
  CheckOptions options;
  std::set<std::string> names;
  for (const OptionField& field : fields(options)) EXPECT_TRUE(names.insert(field.name).second) << field.name;
  for (const char* key : {"resolution", "submap_distance", "submap_rotation", "min_range", "max_range", "min_scans",
                          "local_min_gap", "d", "overlap_min", "matched_min", "drift_per_metre", "occupancy_weight_m",
                          "fit", "floor", "registration", "tolerance", "alpha", "prior_inconsistent", "min_decided"}) {
    EXPECT_EQ(names.count(key), 1U) << key;
  }
}

}  // namespace
}  // namespace kilter
