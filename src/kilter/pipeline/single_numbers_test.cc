// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two ways in which a single number for a whole map is known to fail: it falls, that is, calls the map better, where
// walls that were one surface with a few centimetres of residual come to stand twice, each of them thin. The same
// scenes, answered by check.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "kilter/pipeline/check.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::furnished_room;
using testing::pose_at;
using testing::robot_log;

constexpr double kRadius_m = 0.3;
constexpr std::size_t kSamples = 400;

struct Neighbourhood {
  Eigen::Vector3d eigenvalues_m2;  // ascending
  Eigen::Vector3d normal;
};

std::optional<Neighbourhood> around(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& at_m) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second_m2 = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const Eigen::Vector3d& point_m : points_m) {
    if ((point_m - at_m).squaredNorm() > kRadius_m * kRadius_m) continue;
    mean_m += point_m;
    second_m2 += point_m * point_m.transpose();
    count += 1.0;
  }
  if (count < 12.0) return std::nullopt;
  mean_m /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second_m2 / count - mean_m * mean_m.transpose());
  return Neighbourhood{solver.eigenvalues().cwiseMax(1e-9), solver.eigenvectors().col(0)};
}

// Mean map entropy (Droeschel and Behnke 2014): differential entropy of normal distributions around points.
double mean_map_entropy(std::span<const Eigen::Vector3d> points_m) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < points_m.size(); i += points_m.size() / kSamples) {
    const auto found = around(points_m, points_m[i]);
    if (!found) continue;
    sum += 0.5 * (3.0 * std::log(2.0 * std::numbers::pi * std::numbers::e) + found->eigenvalues_m2.array().log().sum());
    count += 1.0;
  }
  return sum / count;
}

// Mean plane variance over planes that are orthogonal to each other (Kornilov and Ferrer 2021), here those of the room.
double orthogonal_plane_variance_m2(std::span<const Eigen::Vector3d> points_m) {
  double sum_m2 = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < points_m.size(); i += points_m.size() / kSamples) {
    const auto found = around(points_m, points_m[i]);
    if (!found || found->eigenvalues_m2[0] > 0.2 * found->eigenvalues_m2[1]) continue;
    if (found->normal.cwiseAbs().maxCoeff() < 0.97) continue;
    sum_m2 += found->eigenvalues_m2[0];
    count += 1.0;
  }
  return sum_m2 / count;
}

struct Journey {
  std::vector<Pose3> truth;
  std::vector<Pose3> believed;
};

std::vector<Eigen::Vector3d> cloud_of(std::span<const Journey> journeys) {
  std::vector<Eigen::Vector3d> points_m;
  std::uint64_t seed = 1;
  for (const Journey& journey : journeys) {
    for (std::size_t k = 0; k < journey.truth.size(); ++k) {
      for (const Eigen::Vector3d& point_m : testing::scan(furnished_room(), journey.truth[k], 0.01, seed++)) {
        points_m.push_back(journey.believed[k] * point_m);
      }
    }
  }
  return points_m;
}

MapState answer_for(std::span<const Journey> journeys) {
  std::vector<RobotLog> robots;
  for (const Journey& journey : journeys) {
    const std::string name(1, static_cast<char>('a' + robots.size()));
    robots.push_back(robot_log(name, furnished_room(), journey.truth, journey.believed, 1 + robots.size()));
  }
  CheckOptions options;
  options.submap.cutting.submap_distance_m = 2.0;
  const auto result = check(robots, options, {}, {.threads = 2});
  return result ? result->system.state : MapState::kUndetermined;
}

std::vector<Pose3> way_through_room(double start_x) {
  std::vector<Pose3> poses;
  for (int i = 0; i < 8; ++i) poses.push_back(pose_at(start_x + 0.7 * i, 2.03 + 0.25 * i, 1.02, 0.15 * i));
  return poses;
}

std::vector<Pose3> moved(std::vector<Pose3> poses, const Pose3& by) {
  for (Pose3& pose : poses) pose = by * pose;
  return poses;
}

// A good merge keeps residuals of a few centimetres, which make its walls thicker; a building that stands twice has
// walls as thin as one robot's.
TEST(SingleNumbers, OrthogonalPlanesRateADoubledBuildingBetter) {
  const auto a = way_through_room(2.01);
  const auto b = way_through_room(3.52);
  const std::vector<Journey> merged = {{a, a}, {b, moved(b, Pose3::from_translation(0.03, 0.03, 0.02))}};
  const std::vector<Journey> doubled = {{a, a}, {b, moved(b, Pose3::from_translation(0.7, 0.6, 0.0))}};
  EXPECT_LT(orthogonal_plane_variance_m2(cloud_of(doubled)), orthogonal_plane_variance_m2(cloud_of(merged)));
  EXPECT_EQ(answer_for(merged), MapState::kConsistent);
  EXPECT_EQ(answer_for(doubled), MapState::kInconsistent);
}

// One robot goes and comes back. Raw, the way back stands half a metre beside the way there; closed, both lie on each
// other but for some centimetres.
TEST(SingleNumbers, EntropyPrefersTheRawMapToTheLoopClosedOne) {
  const auto there = way_through_room(2.01);
  std::vector<Pose3> truth = there;
  truth.insert(truth.end(), there.rbegin(), there.rend());
  const auto drawn = [&](const Pose3& drift) {
    std::vector<Pose3> believed = there;
    const auto back = moved({there.rbegin(), there.rend()}, drift);
    believed.insert(believed.end(), back.begin(), back.end());
    return std::vector<Journey>{{truth, believed}};
  };
  const auto raw = drawn(Pose3::from_translation(0.6, 0.7, 0.5));
  const auto closed = drawn(Pose3::from_translation(0.03, 0.03, 0.02));
  EXPECT_LT(mean_map_entropy(cloud_of(raw)), mean_map_entropy(cloud_of(closed)));
  EXPECT_EQ(answer_for(raw), MapState::kInconsistent);
  EXPECT_EQ(answer_for(closed), MapState::kConsistent);
}

}  // namespace
}  // namespace kilter
