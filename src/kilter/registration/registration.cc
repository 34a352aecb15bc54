// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/registration.h"

#include "kilter/registration/oicp.h"
#include "kilter/registration/point_to_plane.h"

namespace kilter {

std::vector<OptionField> fields(RegistrationOptions& o) {
  return {
      choice_option("registration", o.method, {"point_to_plane", "oicp"},
                    "How pairs are aligned for Theta, the offset and the constraint."),
      count_option("registration_iterations", o.max_iterations, 1, 10000, "Iterations after which alignment gives up."),
      real_option("registration_max_rotation", o.max_rotation_rad, Unit::kRadian, 0.0, 3.15,
                  "An alignment that turns farther than this from the map's pose is refused."),
      real_option(
          "registration_wide", o.wide_translation_m, Unit::kMetre, 0.0, 50.0,
          "How far from the map's pose a second, wide search looks where the first one cannot be trusted, or "
          "as far as odometry may have drifted, if that is more, and 1 m up and down at most; 0 leaves it out."),
      count_option("registration_points", o.max_points, 100, 100000000,
                   "Voxels of each submap used while iterating, about; the end is judged on all of them."),
  };
}

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kMaxIterations:
      return "did not settle";
    case StopReason::kTooFewMatches:
      return "too few matches";
    case StopReason::kOverlapLost:
      return "overlap was lost";
    case StopReason::kOutOfRange:
      return "moved out of range";
    case StopReason::kDegenerate:
      return "nothing in the scene fixes the pose";
  }
  return "";
}

RegistrationResult align_submaps(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                 const Pose3& T_target_source_start, const RegistrationOptions& options,
                                 const RegistrationPrior& prior) {
  return options.method == RegistrationMethod::kOicp
             ? align_oicp(source, target, T_target_source_start, options, prior)
             : align_point_to_plane(source, target, T_target_source_start, options, prior);
}

}  // namespace kilter
