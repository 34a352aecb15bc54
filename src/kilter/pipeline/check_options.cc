// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "kilter/pipeline/check.h"

namespace kilter {

std::vector<OptionField> fields(CheckOptions& o) {
  std::vector<OptionField> all;
  const auto append = [&](std::vector<OptionField> stage) {
    std::copy_if(std::make_move_iterator(stage.begin()), std::make_move_iterator(stage.end()), std::back_inserter(all),
                 [&](const OptionField& field) {
                   return std::none_of(all.begin(), all.end(),
                                       [&](const auto& known) { return known.name == field.name; });
                 });
  };
  append(fields(o.submap.occupancy));
  append(fields(o.submap.cutting));
  append(fields(o.pairing));
  append(fields(o.matching));  // owns d; the distribution's row of that name is the same key
  append(fields(o.distribution));
  append(fields(o.gamma));
  append(fields(o.registration));
  append(fields(o.judge));
  append(fields(o.picture));
  return all;
}

Expected<void> validate(const CheckOptions& o) {
  constexpr double kMostVoxels = 200.0;
  if (auto fit = validate(o.submap.occupancy); !fit) return pass_up(fit.error());
  const double d_m = o.matching.max_distance_m;
  const double resolution_m = o.submap.occupancy.resolution_m;
  constexpr double kRounding = 1e-9;
  if (d_m < resolution_m * (1.0 - kRounding)) {
    return fail(ErrorCode::kConfig, fmt::format("d: expected a voxel or more, {:g} m, found {:g} m", resolution_m, d_m),
                {}, "raise d to some voxels, or use a finer resolution");
  }
  if (d_m <= kMostVoxels * resolution_m * (1.0 + kRounding)) return {};
  return fail(ErrorCode::kConfig,
              fmt::format("d: expected at most {:g} voxels, {:g} m at a resolution of {:g} m, found {:g} m",
                          kMostVoxels, kMostVoxels * resolution_m, resolution_m, d_m),
              {}, "lower d, or use a coarser resolution");
}

void apply_seed_preset(CheckOptions& o) {
  o.matching.position = VoxelPosition::kCentre;
  o.matching.occupancy_weight_m = 1.0;  // Eq. (8) as printed: the probability counts as metres
  o.distribution.method = DistributionFitMethod::kMoments;
  o.gamma.floor = GammaFloor::kNone;
  o.registration.method = RegistrationMethod::kOicp;
  o.registration.max_iterations = 400;  // the paper names no limit; point to point creeps along walls
  o.judge.method = JudgeMethod::kGamma;
}

}  // namespace kilter
