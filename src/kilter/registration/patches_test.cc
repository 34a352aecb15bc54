// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

std::vector<PlaneResidual> scattered(std::size_t count, double reach_m) {
  Rng rng(11, 0);
  std::vector<PlaneResidual> residuals;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point_m(rng.uniform(-reach_m, reach_m), rng.uniform(-reach_m, reach_m), rng.uniform(-2, 2));
    const Eigen::Vector3d normal = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    residuals.push_back({point_m, normal, 0.05 * rng.normal(), rng.uniform(0.1, 1.0)});
  }
  return residuals;
}

// However many patches there are, nothing is lost and nothing counted twice.
TEST(Patches, AddUpToTheNormalEquations) {
  for (const double reach_m : {0.3, 5.0, 80.0}) {
    const std::vector<PlaneResidual> residuals = scattered(5000, reach_m);
    const NormalEquations equations = build_normal_equations(residuals);
    for (const double cell_m : {0.8, 8.0}) {
      Vector6 gradient = Vector6::Zero();
      double weight = 0.0;
      double squares_m2 = 0.0;
      for (const Patch& patch : patches_of(residuals, equations, cell_m)) {
        gradient += patch.gradient;
        weight += patch.weight;
        squares_m2 += patch.squares_m2;
      }
      EXPECT_NEAR((gradient - equations.gradient).norm(), 0.0, 1e-9);
      EXPECT_NEAR(weight, equations.weight, 1e-9);
      EXPECT_NEAR(squares_m2, equations.squares_m2, 1e-9);
    }
  }
}

TEST(Patches, ASurfaceMatchedFromBothSidesIsOneAndPullsTwice) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::vector<PlaneResidual> residuals = {{{0.0, 0.1, 0.0}, up, 0.01, 1.0}, {{0.0, -0.1, 0.0}, -up, -0.01, 1.0}};
  const NormalEquations equations = build_normal_equations(residuals);
  const std::vector<Patch> sides = patches_of(residuals, equations, 2.0);  // the lower one first
  const std::vector<Patch> surfaces = surfaces_of(residuals, equations, 2.0);
  ASSERT_EQ(sides.size(), 2U);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_NEAR((surfaces[0].pull - (sides[1].pull - sides[0].pull)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((surfaces[0].gradient - equations.gradient).norm(), 0.0, 1e-12);
}

TEST(Patches, AreThePointsOfACellThatFaceAlike) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d aside = Eigen::Vector3d::UnitX();
  std::vector<PlaneResidual> residuals;
  for (const double x : {-20.0, 0.0, 20.0}) {
    residuals.push_back({{x, 0.1, 0.0}, up, 0.01, 1.0});
    residuals.push_back({{x, -0.1, 0.0}, up, 0.02, 0.5});
    residuals.push_back({{x, 0.0, 0.1}, aside, 0.03, 0.25});
  }
  const NormalEquations equations = build_normal_equations(residuals);
  const std::vector<Patch> patches = patches_of(residuals, equations, 2.0);
  ASSERT_EQ(patches.size(), 6U);  // three places, each with two ways to face
  for (std::size_t k = 0; k < patches.size(); k += 2) {
    const double weight = patches[k].weight + patches[k + 1].weight;
    EXPECT_NEAR(weight, 1.75, 1e-12);
    EXPECT_NEAR(std::min(patches[k].weight, patches[k + 1].weight), 0.25, 1e-12);
  }
  EXPECT_EQ(patches_of(residuals, equations, 1000.0).size(), 2U);
}

TEST(Patches, OfPlanesAreLayersOfWhatFacesAlike) {
  std::vector<PlaneResidual> residuals;
  Rng rng(12, 0);
  for (int i = 0; i < 900; ++i) {
    const double height_m = i % 3 == 0 ? 0.0 : 3.0;
    residuals.push_back({{rng.uniform(-30, 30), rng.uniform(-30, 30), height_m}, Eigen::Vector3d::UnitZ(), 0.01, 1.0});
  }
  const NormalEquations equations = build_normal_equations(residuals);
  const std::vector<Patch> planes = planes_of(residuals, equations, 0.5);
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_NEAR(planes[0].weight, 300.0, 1e-9);
  EXPECT_NEAR(planes[1].weight, 600.0, 1e-9);
}

// A wall that is matched from both sides is one wall, and off by one offset.
TEST(Patches, OfAPlaneTakeBothDirectionsForOne) {
  Rng rng(14, 0);
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, -0.8, 0), Eigen::Vector3d(0, 0, -1)}) {
    std::vector<PlaneResidual> residuals;
    for (int i = 0; i < 400; ++i) {
      const double sign = i % 2 == 0 ? 1.0 : -1.0;
      Eigen::Vector3d at_m(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3));
      at_m -= normal * normal.dot(at_m);
      residuals.push_back({at_m, sign * normal, sign * 0.01, 1.0});
    }
    const std::vector<Patch> planes = planes_of(residuals, build_normal_equations(residuals), 0.5);
    ASSERT_EQ(planes.size(), 1U);
    EXPECT_NEAR(planes[0].weight, 400.0, 1e-9);
    EXPECT_GT(planes[0].pull.norm(), 399.0);
    EXPECT_NEAR(std::abs(planes[0].gradient.dot(planes[0].pull)), 0.01 * planes[0].pull.squaredNorm(), 1e-6);
  }
}

}  // namespace
}  // namespace kilter
