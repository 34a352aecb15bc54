// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/lidar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace kilter {
namespace {

using Eigen::Vector3d;

LidarModel clean_model() {
  LidarModel model;
  model.range_noise_m = 0.0;
  model.range_step_m = 0.0;
  model.dropout = 0.0;
  return model;
}

Pose3 standing(double /*time_s*/) { return Pose3::from_translation(0.0, 0.0, 1.0); }

// A closed room, 20 x 12 x 3 m, the sensor 1 m above the middle of its floor.
TriangleWorld room() {
  TriangleWorld world;
  world.fixed.add_box({.center_m = {0.0, 0.0, 1.5}, .size_m = {20.0, 12.0, 3.0}}, Material::kPlaster);
  return world;
}

SimulatedScan scan_of(const TriangleWorld& world, const LidarModel& model, const SensorMotion& motion = standing,
                      Rng rng = Rng(1, 0)) {
  return simulate_scan(*RayCaster::build(world), model, motion, 0.0, rng);
}

double distance_to_room_m(const Eigen::Vector3f& point_sensor) {
  const Vector3d p = point_sensor.cast<double>() + Vector3d(0.0, 0.0, -0.5);  // room's centre
  return std::min({std::abs(10.0 - std::abs(p.x())), std::abs(6.0 - std::abs(p.y())), std::abs(1.5 - std::abs(p.z()))});
}

TEST(Lidar, EveryBeamReturnsFromAClosedRoomAndLiesOnIt) {
  const SimulatedScan scan = scan_of(room(), clean_model());
  ASSERT_EQ(scan.cloud.points_m.size(), 16U * 1800U);
  ASSERT_EQ(scan.intensity.size(), scan.cloud.points_m.size());
  for (const Eigen::Vector3f& point : scan.cloud.points_m) ASSERT_LT(distance_to_room_m(point), 1e-5);
}

TEST(Lidar, BeamsSpreadEvenlyOverTheirFan) {
  for (const int beams : {16, 32, 64}) {
    LidarModel model = *lidar_model(beams);
    model.columns = 36;
    const SimulatedScan scan = scan_of(room(), model);
    double lowest = 1.0;
    double highest = -1.0;
    for (const Eigen::Vector3f& point : scan.cloud.points_m) {
      const double elevation = std::asin(static_cast<double>(point.z() / point.norm()));
      lowest = std::min(lowest, elevation);
      highest = std::max(highest, elevation);
    }
    EXPECT_NEAR(lowest, model.elevation_low_rad, 1e-6);
    EXPECT_NEAR(highest, model.elevation_high_rad, 1e-6);
  }
  EXPECT_EQ(lidar_model(17).error().code, ErrorCode::kInvalidArgument);
}

TEST(Lidar, RangeNoiseHasTheGivenDeviationAndNoBias) {
  const SimulatedScan truth = scan_of(room(), clean_model());
  LidarModel model = clean_model();
  model.range_noise_m = 0.03;
  model.divergence_rad = 1e-6;  // no mixed pixels
  const SimulatedScan noisy = scan_of(room(), model);
  ASSERT_EQ(noisy.cloud.points_m.size(), truth.cloud.points_m.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.cloud.points_m.size(); ++i) {
    const double error = static_cast<double>(noisy.cloud.points_m[i].norm() - truth.cloud.points_m[i].norm());
    sum += error;
    squares += error * error;
  }
  const auto count = static_cast<double>(truth.cloud.points_m.size());
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 0.03 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.03 * 4.0 / std::sqrt(2.0 * count));
}

TEST(Lidar, LosesTheGivenShareOfReturns) {
  LidarModel model = clean_model();
  model.dropout = 0.1;
  const double all = 16.0 * 1800.0;
  EXPECT_NEAR(static_cast<double>(scan_of(room(), model).cloud.points_m.size()), 0.9 * all,
              4.0 * std::sqrt(0.09 * all));
}

TEST(Lidar, SwallowsWhatIsTooNearAndFadesOnDarkGrazingGround) {
  LidarModel model = clean_model();
  model.min_range_m = 8.0;
  for (const Eigen::Vector3f& point : scan_of(room(), model).cloud.points_m) ASSERT_GE(point.norm(), 8.0F - 1e-5F);

  TriangleWorld open;
  open.fixed.add_floor(-300.0, -300.0, 300.0, 300.0, 0.0, Material::kAsphalt);
  LidarModel fine = clean_model();
  fine.beams = 64;
  fine.elevation_high_rad = -0.002;
  float farthest = 0.0F;
  for (const Eigen::Vector3f& point : scan_of(open, fine).cloud.points_m) farthest = std::max(farthest, point.norm());
  EXPECT_GT(farthest, 10.0F);
  EXPECT_LT(farthest, 45.0F) << "asphalt at 1 degree does not answer from 100 m";
}

TEST(Lidar, MixedPixelsHangBetweenAPoleAndTheWallBehind) {
  TriangleWorld world = room();
  world.fixed.add_box({.center_m = {9.7, 0.0, 1.5}, .size_m = {0.1, 0.5, 3.0}}, Material::kMetal);
  const auto floating = [&](double divergence_rad) {
    LidarModel model = clean_model();
    model.divergence_rad = divergence_rad;
    int count = 0;
    for (std::uint64_t turn = 0; turn < 10; ++turn) {
      for (const Eigen::Vector3f& p : scan_of(world, model, standing, Rng(turn, 0)).cloud.points_m) {
        if (std::abs(p.y()) < 1.0F && std::abs(p.z()) < 0.9F && p.x() > 9.67F && p.x() < 9.98F) ++count;
      }
    }
    return count;
  };
  EXPECT_EQ(floating(1e-6), 0);
  EXPECT_GT(floating(0.003), 15);  // 2 edges x 6 beams x 10 turns, about 0.4 each
}

// Sensor turns at 1 rad/s and drives at 2 m/s while the lidar spins.
Pose3 driving(double time_s) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(time_s, Vector3d::UnitZ())), Vector3d(2.0 * time_s, 0.0, 1.0)};
}

TEST(Lidar, PerfectDeskewingPutsPointsBackAndARawScanIsSmeared) {
  LidarModel model = clean_model();
  model.motion_residual = 0.0;
  double worst = 0.0;
  for (const auto& point : scan_of(room(), model, driving).cloud.points_m) {
    worst = std::max(worst, distance_to_room_m(point));
  }
  EXPECT_LT(worst, 1e-5);
  model.motion_residual = 1.0;
  worst = 0.0;
  for (const auto& point : scan_of(room(), model, driving).cloud.points_m) {
    worst = std::max(worst, distance_to_room_m(point));
  }
  EXPECT_GT(worst, 0.1);
}

TEST(Lidar, SameNumbersInSameBytesOut) {
  const auto bytes = [](const SimulatedScan& scan) {
    std::string text(scan.cloud.points_m.size() * sizeof(Eigen::Vector3f), '\0');
    std::memcpy(text.data(), scan.cloud.points_m.data(), text.size());
    return text;
  };
  const LidarModel model;
  EXPECT_EQ(bytes(scan_of(room(), model, driving, Rng(3, 4))), bytes(scan_of(room(), model, driving, Rng(3, 4))));
  EXPECT_NE(bytes(scan_of(room(), model, driving, Rng(3, 4))), bytes(scan_of(room(), model, driving, Rng(3, 5))));
}

}  // namespace
}  // namespace kilter
