// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/patches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "kilter/occupancy/key_numbers.h"
#include "kilter/registration/sum_jacobians.h"

namespace kilter {
namespace {

// A plane's points lie in one layer of this thickness along the mean normal of what faces alike. [m]
constexpr double kLayer_m = 1.0;

// Which of the 26 directions of a cell's neighbours a normal is nearest to.
int facing_of(const Eigen::Vector3d& normal) {
  constexpr double kTangent = 0.41421356237309503;  // of 22.5 degrees: half way between an axis and a diagonal
  const double least = kTangent * normal.cwiseAbs().maxCoeff();
  int facing = 0;
  for (int axis = 0; axis < 3; ++axis) {
    facing = 3 * facing + (normal[axis] > least ? 2 : normal[axis] < -least ? 0 : 1);
  }
  return facing;
}

// Of a cell and what of it faces alike. Sorts by z, y, x and facing.
std::uint64_t patch_key(const Eigen::Vector3i& cell, int facing) {
  constexpr int kFacingBits = 5;
  constexpr int kBits = 19;
  const auto axis = [](int value) {
    return static_cast<std::uint64_t>(value + (1 << (kBits - 1))) & ((1U << kBits) - 1);
  };
  return ((axis(cell.z()) << kBits | axis(cell.y())) << kBits | axis(cell.x())) << kFacingBits |
         static_cast<std::uint64_t>(facing);
}

// Half away from zero.
int rounded(double value) { return static_cast<int>(value + (value < 0.0 ? -0.5 : 0.5)); }

std::uint64_t patch_key_of(const PlaneResidual& r, const Eigen::Vector3d& centre_m, double cell_m) {
  const Eigen::Vector3d cell = (r.point_m - centre_m) / cell_m;
  return patch_key({rounded(cell.x()), rounded(cell.y()), rounded(cell.z())}, facing_of(r.direction));
}

// The same residual seen from one of its plane's two sides, whichever of the two it was.
PlaneResidual from_one_side(PlaneResidual r) {
  constexpr int kNoFacing = 13;  // of the 27 neighbours the cell itself; opposite ones add up to twice as much
  if (facing_of(r.direction) > kNoFacing) return r;
  r.direction = -r.direction;
  r.residual_m = -r.residual_m;
  return r;
}

// Sums over residuals by key.
class PatchSums {
 public:
  void add(std::uint64_t key, const PlaneResidual& r, const Eigen::Vector3d& centre_m) {
    const std::uint32_t number = numbers_.find_or_add(key);
    if (number == patches_.size()) patches_.emplace_back(key, Patch{});
    Patch& patch = patches_[number].second;
    const Vector6 pull = r.weight * plain_jacobian(r, centre_m);
    patch.pull += pull;
    patch.gradient += r.residual_m * pull;
    patch.weight += r.weight;
    patch.squares_m2 += r.weight * r.residual_m * r.residual_m;
  }

  // Sorted by key, in the scaled unknowns.
  [[nodiscard]] std::vector<Patch> take(const Matrix6& unscale) {
    std::sort(patches_.begin(), patches_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Patch> sums;
    sums.reserve(patches_.size());
    for (const auto& [key, patch] : patches_) {
      sums.push_back(patch);
      sums.back().pull = unscale.transpose() * patch.pull;
      sums.back().gradient = unscale.transpose() * patch.gradient;
    }
    return sums;
  }

 private:
  KeyNumbers numbers_;
  std::vector<std::pair<std::uint64_t, Patch>> patches_;  // by number
};

}  // namespace

std::vector<Patch> patches_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                              double cell_m) {
  PatchSums sums;
  for (const PlaneResidual& r : residuals) {
    sums.add(patch_key_of(r, equations.centre_m, cell_m), r, equations.centre_m);
  }
  return sums.take(equations.unscale);
}

std::vector<Patch> surfaces_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                               double cell_m) {
  PatchSums sums;
  for (const PlaneResidual& either : residuals) {
    const PlaneResidual r = from_one_side(either);
    sums.add(patch_key_of(r, equations.centre_m, cell_m), r, equations.centre_m);
  }
  return sums.take(equations.unscale);
}

std::vector<std::uint32_t> patch_numbers(std::span<const PlaneResidual> residuals, const Eigen::Vector3d& centre_m,
                                         double cell_m) {
  KeyNumbers numbers;
  std::vector<std::uint32_t> of_residuals;
  of_residuals.reserve(residuals.size());
  for (const PlaneResidual& r : residuals) {
    of_residuals.push_back(numbers.find_or_add(patch_key_of(r, centre_m, cell_m)));
  }
  return of_residuals;
}

std::vector<Patch> planes_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations, double shift) {
  std::map<int, Eigen::Vector3d> normals;
  for (const PlaneResidual& either : residuals) {
    const PlaneResidual r = from_one_side(either);
    normals.try_emplace(facing_of(r.direction), Eigen::Vector3d::Zero()).first->second += r.weight * r.direction;
  }
  for (auto& [facing, normal] : normals) normal.normalize();
  PatchSums sums;
  for (const PlaneResidual& either : residuals) {
    const PlaneResidual r = from_one_side(either);
    const int facing = facing_of(r.direction);
    const double along_m = normals.at(facing).dot(r.point_m - equations.centre_m);
    const auto layer = static_cast<int>(std::floor(along_m / kLayer_m + shift));
    sums.add(patch_key({layer, 0, 0}, facing), r, equations.centre_m);
  }
  return sums.take(equations.unscale);
}

}  // namespace kilter
