// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/worlds/floor_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kilter/simulation/ray_caster.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The longest of many level looks round from points along x = 0, from y = 0 to `to_y`.
double longest_look_m(const TriangleMesh& mesh, double to_y) {
  constexpr int kDirections = 1440;
  const Expected<RayCaster> caster = RayCaster::build({mesh, {}});
  EXPECT_TRUE(caster.has_value());
  double longest_m = 0.0;
  for (double y = 0.0; y <= to_y; y += 0.5) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const auto hit = caster->at(0.0).first_hit({0.0, y, 1.0}, Vector3d(std::cos(angle), std::sin(angle), 0.0), 100.0);
      longest_m = std::max(longest_m, hit ? hit->range_m : 100.0);
    }
  }
  return longest_m;
}

TriangleMesh hedges(const FloorPlan& plan, std::uint64_t seed) {
  TriangleMesh mesh;
  Rng rng(seed, 0);
  plan.build_hedges(mesh, 4.0, rng);
  return mesh;
}

TEST(FloorPlan, NobodyLooksOutThroughACornerOfWalls) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, 0);
    const double angle = rng.uniform(-0.8, 0.8);
    const double width_m = rng.uniform(1.6, 2.4);
    FloorPlan plan;
    plan.add_corridor({0.0, 0.0}, {0.0, 8.0}, 2.0);
    plan.add_corridor({0.0, 8.0}, {6.0 * std::cos(angle), 8.0 + 6.0 * std::sin(angle)}, width_m);
    plan.add_passage({0.0, 3.0}, {-5.0, 3.0 + rng.uniform(-2.0, 2.0)}, 0.8);
    TriangleMesh mesh;
    plan.build(mesh, 3.0, {}, 0.0, rng);
    EXPECT_LT(longest_look_m(mesh, 8.0), 17.0) << seed;
  }
}

TEST(FloorPlan, AWallThatTwoCorridorsShareStandsOnce) {
  FloorPlan plan;
  plan.add_corridor({0.0, 0.0}, {0.0, 8.0}, 2.0);
  plan.add_corridor({0.0, 8.0}, {6.0, 8.0}, 2.0);
  TriangleMesh mesh;
  Rng rng(1, 0);
  constexpr double kNowhere_m = 100.0;  // no thing stands by a wall
  plan.build(mesh, 3.0, {{{0.0, 0.0, 0.0}, {0.0, 8.0, 0.0}}}, kNowhere_m, rng);
  // Four of the first corridor, three of the second; floor and ceiling. Two triangles each.
  EXPECT_EQ(mesh.triangles.size(), 2U * (4U + 3U + 2U));
}

TEST(FloorPlan, NobodyLooksOutThroughACornerOfHedges) {
  FloorPlan plan;
  plan.add_passage({0.0, -2.5}, {0.0, 12.5}, 5.0);
  plan.add_passage({-2.5, 10.0}, {9.0, 10.0}, 5.0);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) EXPECT_LT(longest_look_m(hedges(plan, seed), 10.0), 17.0) << seed;
}

TEST(FloorPlan, AnOpeningBetweenHedgesStaysOpen) {
  FloorPlan plan;
  plan.add_passage({0.0, -2.5}, {0.0, 12.5}, 5.0);
  plan.add_passage({0.0, 5.0}, {20.0, 5.0}, 2.0);
  EXPECT_NEAR(longest_look_m(hedges(plan, 1), 10.0), 20.0, 1.5);
}

}  // namespace
}  // namespace kilter
