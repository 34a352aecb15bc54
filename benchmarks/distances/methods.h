// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

inline constexpr double kLimit_m = 1.0;
inline constexpr float kNone = -1.0F;  // what stands for the distance where nothing is within the limit

// A submap's map and the points that stand for its voxels.
struct Side {
  VoxelMap map;
  std::vector<Eigen::Vector3f> points_m;
};

// One way to find how far each of the source's points is from the target's nearest, under each pose T_target_source.
// With `build`, everything that it needs is made anew; without, it uses what it has.
struct Method {
  std::string name;
  std::function<void(std::span<const Pose3> poses, std::vector<float>& distances_m, bool build)> run;
};

inline Eigen::Vector3d moved(const Eigen::Isometry3d& T, const Eigen::Vector3f& point_m) {
  return T * point_m.cast<double>();
}

// A method that makes a State of the target, and asks it for one point after the other.
template <typename State>
[[nodiscard]] Method point_by_point(std::string name, const Side& source, const Side& target,
                                    float (*distance_of)(State& state, const Eigen::Vector3f& at_m)) {
  return {std::move(name), [&source, &target, distance_of, state = std::make_shared<std::unique_ptr<State>>()](
                               std::span<const Pose3> poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(target);
            for (const Pose3& pose : poses) {
              const Eigen::Isometry3d T = pose.isometry();
              for (std::size_t i = 0; i < source.points_m.size(); ++i) {
                distances_m[i] = distance_of(**state, moved(T, source.points_m[i]).cast<float>());
              }
            }
          }};
}

// What kilter has: exact distances of all voxels together, and of one after the other; and the field that registration
// asks, which is no exact answer.
[[nodiscard]] Method all_together(const Side& source, const Side& target);
[[nodiscard]] Method one_by_one(const Side& source, const Side& target);
[[nodiscard]] Method by_field(const Side& source, const Side& target);

// Debian's packages, each where it is installed.
[[nodiscard]] Method by_nanoflann(const Side& source, const Side& target);
[[nodiscard]] Method by_pcl(const Side& source, const Side& target);
[[nodiscard]] Method by_open3d(const Side& source, const Side& target);
// A distance for each cell of the target's box, read at the cell of a point.
[[nodiscard]] Method by_dynamic_edt(const Side& source, const Side& target);

}  // namespace kilter
