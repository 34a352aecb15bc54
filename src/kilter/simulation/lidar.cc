// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/lidar.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

// What one beam of one column met, before noise.
struct Echo {
  Vector3d direction;  // sensor frame at the column's time
  Vector3d point_m;    // world frame
  RayHit hit;
  double cos_incidence = 1.0;
};
using Column = std::vector<std::optional<Echo>>;

double elevation_rad(const LidarModel& model, int beam) {
  if (model.beams == 1) return 0.5 * (model.elevation_low_rad + model.elevation_high_rad);
  const double share = static_cast<double>(beam) / (model.beams - 1);
  return model.elevation_low_rad + share * (model.elevation_high_rad - model.elevation_low_rad);
}

// Time of a column relative to the middle of the turn.
double column_time_s(const LidarModel& model, int column) {
  return ((column + 0.5) / model.columns - 0.5) / model.rate_hz;
}

Column cast_column(const RayCaster::Moment& moment, const LidarModel& model, const Pose3& T_world_sensor, int column) {
  const Eigen::Matrix3d R_world_sensor = T_world_sensor.rotation_matrix();
  const double azimuth = std::numbers::pi - kTwoPi * (column + 0.5) / model.columns;  // clockwise, seam behind
  Column echoes(static_cast<std::size_t>(model.beams));
  for (int beam = 0; beam < model.beams; ++beam) {
    const double elevation = elevation_rad(model, beam);
    const Vector3d direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                             std::sin(elevation));
    const Vector3d ray = R_world_sensor * direction;
    const std::optional<RayHit> hit = moment.first_hit(T_world_sensor.translation_m(), ray, model.max_range_m);
    if (!hit) continue;
    echoes[static_cast<std::size_t>(beam)] =
        Echo{direction, T_world_sensor.translation_m() + hit->range_m * ray, *hit, -hit->normal.dot(ray)};
  }
  return echoes;
}

// Each lies off the other's surface: there is an edge between them.
bool edge_between(const Echo& a, const Echo& b) {
  constexpr double kOffSurface_m = 0.05;
  const Vector3d step_m = b.point_m - a.point_m;
  return std::abs(a.hit.normal.dot(step_m)) > kOffSurface_m && std::abs(b.hit.normal.dot(step_m)) > kOffSurface_m;
}

// Mixed pixel: an edge lies anywhere in the gap between two columns; if it is inside the beam, the neighbour's surface
// gets a share of the light, and within one pulse length the two echoes become one in between.
double mixed_range_m(const LidarModel& model, const Echo& echo, const Echo* neighbour, double edge_rad) {
  const double range_m = echo.hit.range_m;
  if (neighbour == nullptr || edge_rad > 0.5 * model.divergence_rad) return range_m;
  const double gap_m = neighbour->hit.range_m - range_m;
  if (std::abs(gap_m) > model.pulse_length_m || !edge_between(echo, *neighbour)) return range_m;
  return range_m + (0.5 - edge_rad / model.divergence_rad) * gap_m;
}

// The range as the sensor reports it, or nothing. Always draws the same count of random numbers.
std::optional<double> measure_m(const LidarModel& model, const Echo& echo, const Echo* neighbour, Rng& rng) {
  const double edge_rad = rng.uniform() * kTwoPi / model.columns;
  const bool lost = rng.uniform() < model.dropout;
  const double noise_m = model.range_noise_m * rng.normal();
  const double limit_m = detection_limit_m(model, reflectivity(echo.hit.material), echo.cos_incidence);
  const double range_m = mixed_range_m(model, echo, neighbour, edge_rad) + noise_m;
  if (lost || range_m > limit_m || range_m > model.keep_range_m || range_m < model.min_range_m) return std::nullopt;
  if (model.range_step_m <= 0.0) return range_m;
  return std::round(range_m / model.range_step_m) * model.range_step_m;
}

const Echo* echo_at(const std::vector<Column>& columns, int column, std::size_t beam) {
  if (column < 0 || column >= static_cast<int>(columns.size())) return nullptr;
  const std::optional<Echo>& echo = columns[static_cast<std::size_t>(column)][beam];
  return echo ? &*echo : nullptr;
}

}  // namespace

std::vector<OptionField> LidarModel::fields() {
  return {
      count_option("columns", columns, 36, 7200, "Firings of the lidar per turn."),
      real_option("rate_hz", rate_hz, Unit::kNone, 0.1, 100.0, "Turns of the lidar per second."),
      real_option("lidar_min_range", min_range_m, Unit::kMetre, 0.0, 10.0, "Nearer returns are swallowed."),
      real_option("lidar_max_range", max_range_m, Unit::kMetre, 1.0, 500.0, "Reach on a bright surface met squarely."),
      real_option("keep_range", keep_range_m, Unit::kMetre, 1.0, 1000.0, "Farther returns are thrown away."),
      real_option("range_noise", range_noise_m, Unit::kMetre, 0.0, 1.0, "Standard deviation of a range."),
      real_option("range_step", range_step_m, Unit::kMetre, 0.0, 0.1, "Ranges are multiples of this; 0 is exact."),
      real_option("dropout", dropout, Unit::kRatio, 0.0, 1.0, "Share of returns lost at random."),
      real_option("divergence", divergence_rad, Unit::kRadian, 1e-6, 0.1, "Full width of a beam."),
      real_option("motion_residual", motion_residual, Unit::kRatio, 0.0, 1.0,
                  "Share of the motion within a turn that is left in the scan; 1 is a raw scan."),
  };
}

Expected<LidarModel> lidar_model(int beams) {
  LidarModel model;
  if (beams == 16) return model;
  model.beams = beams;
  if (beams == 32) {
    model.elevation_low_rad = -25.0 * kDegree;
    model.elevation_high_rad = 15.0 * kDegree;
    return model;
  }
  if (beams == 64) {
    model.elevation_low_rad = -22.5 * kDegree;
    model.elevation_high_rad = 22.5 * kDegree;
    return model;
  }
  return fail(ErrorCode::kInvalidArgument, "there is no lidar with " + std::to_string(beams) + " beams", {},
              "use 16, 32 or 64");
}

double detection_limit_m(const LidarModel& model, double reflectivity, double cos_incidence) {
  constexpr double kBright = 0.8;
  const double light = std::max(0.0, reflectivity * cos_incidence) / kBright;
  return model.max_range_m * std::min(1.0, std::sqrt(std::sqrt(light)));
}

SimulatedScan simulate_scan(const RayCaster& world, const LidarModel& model, const SensorMotion& T_world_sensor,
                            double time_s, Rng rng) {
  KILTER_EXPECTS(model.beams >= 1 && model.columns >= 1 && model.rate_hz > 0.0);
  const Pose3 T_scan_world = T_world_sensor(time_s).inverse();
  std::vector<Column> columns;
  std::vector<Pose3> T_scan_column;  // as deskewing believes it
  for (int column = 0; column < model.columns; ++column) {
    const double column_s = time_s + column_time_s(model, column);
    const Pose3 T = T_world_sensor(column_s);
    columns.push_back(cast_column(world.at(column_s), model, T, column));
    T_scan_column.push_back(Pose3::exp((1.0 - model.motion_residual) * (T_scan_world * T).log()));
  }

  SimulatedScan scan;
  for (int column = 0; column < model.columns; ++column) {
    const int side = (rng.bits() >> 63) != 0 ? 1 : -1;
    for (std::size_t beam = 0; beam < static_cast<std::size_t>(model.beams); ++beam) {
      const Echo* echo = echo_at(columns, column, beam);
      if (echo == nullptr) continue;
      const std::optional<double> range_m = measure_m(model, *echo, echo_at(columns, column + side, beam), rng);
      if (!range_m) continue;
      const Vector3d point_m = T_scan_column[static_cast<std::size_t>(column)] * (*range_m * echo->direction).eval();
      scan.cloud.add(static_cast<float>(point_m.x()), static_cast<float>(point_m.y()), static_cast<float>(point_m.z()));
      scan.intensity.push_back(static_cast<float>(reflectivity(echo->hit.material) * echo->cos_incidence));
    }
  }
  return scan;
}

}  // namespace kilter
