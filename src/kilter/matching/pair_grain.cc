// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/pair_grain.h"

#include <algorithm>
#include <cmath>

namespace kilter {
namespace {

// A surface lies anywhere in its cell with equal probability.
double variance_in_cell_m2(double cell_m) { return cell_m * cell_m / 12.0; }

// A cell of several voxels shows its face, which is half a cell off its centre, less half a voxel.
double face_m(const VoxelMap& map) { return 0.5 * std::max(map.cell_m() - map.resolution_m(), 0.0); }

}  // namespace

double PairGrain::sigma_m() const { return std::sqrt(variance_m2); }

PairGrain grain_of(const VoxelMap& source, const VoxelMap& target) {
  PairGrain grain;
  grain.cell_m = std::max(source.cell_m(), target.cell_m());
  grain.edge_m = std::max(target.resolution_m(), grain.cell_m);
  // Of two maps of equal cells, both show the face that both saw; else the one stands in front by as much.
  const double bias_m = face_m(source) - face_m(target);
  grain.variance_m2 = variance_in_cell_m2(source.cell_m()) + variance_in_cell_m2(target.cell_m()) + bias_m * bias_m;
  grain.most_m = 0.5 * (source.cell_m() + target.cell_m()) + std::abs(bias_m);
  grain.voxels_per_cell = std::pow(grain.edge_m / target.resolution_m(), 3);
  return grain;
}

}  // namespace kilter
