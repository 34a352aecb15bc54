// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kilter/registration/normal_equations.h"

namespace kilter {

/// Residuals that are off together, as the voxels of one surface are: what they add to the normal equations, in the
/// scaled unknowns (NormalEquations::unscale), with J the Jacobian.
struct Patch {
  Vector6 gradient = Vector6::Zero();  ///< sum w J r
  Vector6 pull = Vector6::Zero();      ///< sum w J: the gradient that a common offset of 1 m would make
  double weight = 0.0;                 ///< sum w
  double squares_m2 = 0.0;             ///< sum w r^2
};

/// Residuals by cell of a lattice about the centre and by facing, which is the nearest of the 26 directions of a cell's
/// neighbours. Sorted by cell. O(residuals).
[[nodiscard]] std::vector<Patch> patches_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                            double cell_m);

/// The same where a surface is one patch although it is matched both ways, from its two sides: what is off is off for
/// both. (patches_of makes two of it; the shares that its users multiply by were chosen so.)
[[nodiscard]] std::vector<Patch> surfaces_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                             double cell_m);

/// The number of each residual's patch, from 0 in the order in which they come; patches as above. O(residuals).
[[nodiscard]] std::vector<std::uint32_t> patch_numbers(std::span<const PlaneResidual> residuals,
                                                       const Eigen::Vector3d& centre_m, double cell_m);

/// Residuals by plane: by facing, forwards or backwards, since what is matched both ways is off by the same offset, and
/// by layer of a metre along the mean normal of all that face so. `shift` is in
/// layers, since a plane may lie where two of them meet.
[[nodiscard]] std::vector<Patch> planes_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                           double shift);

}  // namespace kilter
