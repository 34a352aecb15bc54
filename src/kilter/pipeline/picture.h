// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/consistency/distribution.h"
#include "kilter/submap/ids.h"

namespace kilter {

/// How much is kept to be drawn.
struct PictureOptions {
  int max_points = 600000;  ///< over all submaps; what exceeds it is thinned evenly
};

[[nodiscard]] std::vector<OptionField> fields(PictureOptions& options);

/// A submap's surface, thinned to its share of the budget and rounded to a lattice of its own.
struct CloudPicture {
  std::uint64_t voxels = 0;                            ///< before thinning
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< of the lattice, in the submap's frame
  double step_m = 0.0;                                 ///< of the lattice, at most 1/65535 of the cloud's extent
  std::vector<std::array<std::uint16_t, 3>> points;    ///< voxel centroids in steps from the origin, in voxel order
  std::vector<std::uint8_t> misalignment;              ///< per point, see Picture::kMisalignmentStep_m

  [[nodiscard]] Eigen::Vector3d point_m(std::size_t i) const {
    return origin_m + step_m * Eigen::Vector3d(points[i][0], points[i][1], points[i][2]);
  }
};

/// One byte per sampled point of one submap of a pair: how far the other submap's nearest surface is, and whether the
/// point stands where the other submap saw through.
struct SamplePicture {
  static constexpr std::uint8_t kSteps = 126;    ///< the paper's d in steps
  static constexpr std::uint8_t kNothing = 127;  ///< nothing within d
  static constexpr std::uint8_t kThrough = 128;  ///< bit: in the other's free space, no surface near

  std::vector<std::uint8_t> before;  ///< with the map's relative pose
  std::vector<std::uint8_t> after;   ///< with the registered one; empty where registration failed
};

/// What a pair's own view needs beside what result.json says. Sample k is shown point k * stride of the cloud.
struct PairPicture {
  PairId id;
  Eigen::Vector3d centre_world_m = Eigen::Vector3d::Zero();  ///< of what both saw, as the target lies
  std::uint32_t stride = 1;
  SamplePicture source;  ///< empty where the pair does not overlap
  SamplePicture target;
  std::optional<DistanceHistogram> registered_histogram;
  std::optional<NormalParent> registered_parent;  ///< the truncated normal once registered
};

/// All that can be seen of a result; same order as its robots, submaps and pairs.
struct Picture {
  /// Misalignment is a byte: 0 = no pair whose registration is believed saw it, else 1 + the largest displacement that
  /// a registration gives this point, in these steps, at most 254 of them. [m]
  static constexpr double kMisalignmentStep_m = 0.01;

  double max_distance_m = 1.0;                      ///< the paper's d
  std::vector<std::vector<Eigen::Vector3d>> paths;  ///< by robot: where its clouds were taken, world frame [m]
  std::vector<CloudPicture> clouds;                 ///< by submap
  std::vector<PairPicture> pairs;
};

}  // namespace kilter
