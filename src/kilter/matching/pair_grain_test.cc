// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/pair_grain.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kilter {
namespace {

VoxelMap map_with(double cell_m) {
  SurfaceVoxels none;
  none.cell_m = cell_m;
  return {0.1, true, {}, std::move(none)};
}

TEST(PairGrain, IsAVoxelWherePointsAreMeansOfHits) {
  const PairGrain grain = grain_of(map_with(0.0), map_with(0.0));
  EXPECT_EQ(grain.edge_m, 0.1);
  EXPECT_EQ(grain.variance_m2, 0.0);
  EXPECT_EQ(grain.most_m, 0.0);
  EXPECT_EQ(grain.voxels_per_cell, 1.0);
}

TEST(PairGrain, AddsATwelfthOfTheSquareOfEachMapsCells) {
  const PairGrain both = grain_of(map_with(0.1), map_with(0.1));
  EXPECT_NEAR(both.variance_m2, 0.01 / 6.0, 1e-15);
  EXPECT_NEAR(both.most_m, 0.1, 1e-15);
  EXPECT_NEAR(grain_of(map_with(0.0), map_with(0.1)).variance_m2, 0.01 / 12.0, 1e-15);
  EXPECT_EQ(both.voxels_per_cell, 1.0);
}

TEST(PairGrain, OfCellsOfManyVoxelsIsTheCell) {
  const PairGrain both = grain_of(map_with(0.5), map_with(0.5));
  EXPECT_EQ(both.edge_m, 0.5);
  EXPECT_NEAR(both.voxels_per_cell, 125.0, 1e-9);
  EXPECT_NEAR(both.variance_m2, 0.25 / 6.0, 1e-15);
  // Against points, the face of a cell stands in front.
  const PairGrain one = grain_of(map_with(0.5), map_with(0.0));
  EXPECT_NEAR(one.variance_m2, 0.25 / 12.0 + 0.04, 1e-15);
  EXPECT_EQ(one.variance_m2, grain_of(map_with(0.0), map_with(0.5)).variance_m2);
}

}  // namespace
}  // namespace kilter
