// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/option_table.h"
#include "kilter/base/rng.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/geometry/pose3.h"
#include "kilter/simulation/ray_caster.h"

namespace kilter {

/// A spinning lidar with evenly spaced beams. The defaults are a 16-beam sensor as the paper used.
struct LidarModel {
  int beams = 16;
  double elevation_low_rad = -0.2617993877991494;  ///< lowest beam; -15 degrees
  double elevation_high_rad = 0.2617993877991494;  ///< highest beam
  int columns = 1800;                              ///< firings per turn
  double rate_hz = 10.0;                           ///< turns per second
  double min_range_m = 0.5;                        ///< nearer returns are swallowed
  double max_range_m = 100.0;                      ///< for a bright surface met squarely
  double keep_range_m = 1000.0;                    ///< farther returns are thrown away, as mappers do
  double range_noise_m = 0.02;                     ///< standard deviation of a range
  double range_step_m = 0.002;                     ///< ranges are multiples of this
  double dropout = 0.005;                          ///< share of returns that get lost for no reason
  double divergence_rad = 0.003;                   ///< full width of a beam
  double pulse_length_m = 0.6;                     ///< nearer echoes than this melt into one
  /// Share of the motion within one turn that is left in the scan: 1 is a raw scan, 0 perfect deskewing. A real
  /// front end leaves a little.
  double motion_residual = 0.02;

  /// Names, units and ranges for the command line.
  [[nodiscard]] std::vector<OptionField> fields();
};

/// The model with 16, 32 or 64 beams. \return kInvalidArgument for other counts.
[[nodiscard]] Expected<LidarModel> lidar_model(int beams);

/// One turn of the sensor.
struct SimulatedScan {
  PointCloud cloud;              ///< sensor frame at the scan's time, column by column
  std::vector<float> intensity;  ///< one per point, in [0, 1]
};

/// T_world_sensor at a time; must be defined half a turn before and after the scan.
using SensorMotion = std::function<Pose3(double time_s)>;

/// One turn centred on `time_s`. Models: range noise and rounding; returns lost at random, at grazing incidence, on
/// dark or distant surfaces; echoes of two surfaces that melt together at an edge (mixed pixels); motion of the
/// sensor and of objects during the turn. The same Rng gives the same bytes.
[[nodiscard]] SimulatedScan simulate_scan(const RayCaster& world, const LidarModel& model,
                                          const SensorMotion& T_world_sensor, double time_s, Rng rng);

/// Largest range at which a surface still answers: falls with the fourth root of the light that comes back, which is
/// slower than the square root of an ideal detector and is what automatic gain makes of it. [m]
[[nodiscard]] double detection_limit_m(const LidarModel& model, double reflectivity, double cos_incidence);

}  // namespace kilter
