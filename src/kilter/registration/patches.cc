// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/patches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "kilter/occupancy/block_index.h"
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

// Sums over residuals by key.
class PatchSums {
 public:
  void add(std::uint64_t key, const PlaneResidual& r, const Eigen::Vector3d& centre_m) {
    // Residuals come block by block, so the next is often of the same patch.
    if (patches_.empty() || patches_[last_].first != key) last_ = find_or_add(key);
    Patch& patch = patches_[last_].second;
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
  std::size_t find_or_add(std::uint64_t key) {
    std::size_t slot = slot_of(key);
    if (table_[slot] == 0) {
      patches_.emplace_back(key, Patch{});
      table_[slot] = static_cast<std::uint32_t>(patches_.size());
      if (2 * patches_.size() <= table_.size()) return patches_.size() - 1;
      table_.assign(4 * table_.size(), 0);
      for (std::size_t i = 0; i < patches_.size(); ++i) {
        table_[slot_of(patches_[i].first)] = static_cast<std::uint32_t>(i + 1);
      }
      return patches_.size() - 1;
    }
    return table_[slot] - 1;
  }

  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::size_t slot = block_hash(key) & (table_.size() - 1);
    while (table_[slot] != 0 && patches_[table_[slot] - 1].first != key) slot = (slot + 1) & (table_.size() - 1);
    return slot;
  }

  std::vector<std::pair<std::uint64_t, Patch>> patches_;
  std::vector<std::uint32_t> table_ = std::vector<std::uint32_t>(256, 0);  // number + 1 of a patch, 0 = empty
  std::size_t last_ = 0;
};

// Half away from zero.
int rounded(double value) { return static_cast<int>(value + (value < 0.0 ? -0.5 : 0.5)); }

}  // namespace

std::vector<Patch> patches_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                              double cell_m) {
  PatchSums sums;
  for (const PlaneResidual& r : residuals) {
    const Eigen::Vector3d cell = (r.point_m - equations.centre_m) / cell_m;
    sums.add(patch_key({rounded(cell.x()), rounded(cell.y()), rounded(cell.z())}, facing_of(r.direction)), r,
             equations.centre_m);
  }
  return sums.take(equations.unscale);
}

std::vector<Patch> planes_of(std::span<const PlaneResidual> residuals, const NormalEquations& equations, double shift) {
  std::map<int, Eigen::Vector3d> normals;
  for (const PlaneResidual& r : residuals) {
    normals.try_emplace(facing_of(r.direction), Eigen::Vector3d::Zero()).first->second += r.weight * r.direction;
  }
  for (auto& [facing, normal] : normals) normal.normalize();
  PatchSums sums;
  for (const PlaneResidual& r : residuals) {
    const int facing = facing_of(r.direction);
    const double along_m = normals.at(facing).dot(r.point_m - equations.centre_m);
    const auto layer = static_cast<int>(std::floor(along_m / kLayer_m + shift));
    sums.add(patch_key({layer, 0, 0}, facing), r, equations.centre_m);
  }
  return sums.take(equations.unscale);
}

}  // namespace kilter
