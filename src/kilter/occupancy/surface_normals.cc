// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/surface_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace kilter {
namespace {

constexpr int kNearRadius = 2;
constexpr int kFarRadius = 4;
constexpr int kEnoughNeighbours = 8;
constexpr int kFewestNeighbours = 5;
// Below this ratio of the middle to the largest spread the support is a line: its normal is arbitrary.
constexpr double kLineRatio = 0.05;

// Centroids are counted in steps of a 256th of a voxel (0.4 mm at 0.1 m). Sums of whole numbers do not depend on their
// order, and wrap around without harm: about a point near by, squares of 9 x 9 x 9 voxels stay below 2^31.
constexpr int kStepsPerVoxel = 256;

using Quad = std::uint32_t __attribute__((vector_size(16)));
using Steps = Eigen::Matrix<std::uint32_t, 3, 1>;

// Sums over centroids: (x, y, z, 1), their squares, and (xy, yz, zx).
struct Moments {
  Quad sum{};
  Quad squares{};
  Quad products{};

  void add(const Moments& other) {
    sum += other.sum;
    squares += other.squares;
    products += other.products;
  }

  [[nodiscard]] int count() const { return static_cast<int>(sum[3]); }
};

Steps steps_of(const VoxelIndex& voxel, const Eigen::Vector3f& centroid_m, double per_metre) {
  Steps steps;
  for (int axis = 0; axis < 3; ++axis) {
    const int corner = voxel[axis] * kStepsPerVoxel;
    const int inside = static_cast<int>(std::floor(centroid_m[axis] * per_metre - corner));
    steps[axis] = static_cast<std::uint32_t>(corner + std::clamp(inside, 0, kStepsPerVoxel - 1));
  }
  return steps;
}

Moments moments_of(const Steps& p) {
  Moments one;
  one.sum = Quad{p.x(), p.y(), p.z(), 1};
  one.squares = one.sum * one.sum;
  one.products = one.sum * Quad{p.y(), p.z(), p.x(), 0};
  return one;
}

// The scatter matrix about the mean, times count^2, exactly. `near` is any point among those summed.
Eigen::Matrix3d scatter_of(const Moments& moments, const Steps& near) {
  const std::uint32_t n = moments.sum[3];
  std::array<std::int64_t, 3> sum{};
  std::array<std::int64_t, 3> squares{};
  std::array<std::int64_t, 3> products{};
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const std::uint32_t about = moments.sum[a] - n * near[a];
    sum[a] = static_cast<std::int32_t>(about);
    squares[a] = static_cast<std::int32_t>(moments.squares[a] - near[a] * (moments.sum[a] + about));
    products[a] = static_cast<std::int32_t>(moments.products[a] - near[a] * moments.sum[b] - near[b] * about);
  }
  Eigen::Matrix3d scatter;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    scatter(a, a) = static_cast<double>(n * squares[a] - sum[a] * sum[a]);
    scatter(a, b) = scatter(b, a) = static_cast<double>(n * products[a] - sum[a] * sum[b]);
  }
  return scatter;
}

// The blocks around one, found once for all of its voxels.
class Neighbourhood {
 public:
  Neighbourhood(const VoxelMap& map, const std::vector<Moments>& moments, const VoxelBlock& block)
      : moments_(moments), corner_(block_of_key(block.key) * kBlockSize) {
    const Eigen::Vector3i at = block_of_key(block.key);
    for (int z = -1, i = 0; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x, ++i) {
          const std::int32_t number = map.find_block(at + Eigen::Vector3i(x, y, z));
          if (number == BlockIndex::kNone) continue;
          const VoxelBlock& near = map.blocks()[static_cast<std::size_t>(number)];
          if (near.voxel_count == 0) continue;
          Layers& layers = layers_[i];
          layers.occupied = &near.occupied;
          std::uint32_t before = near.first_voxel;
          for (std::size_t layer = 0; layer < kBlockSize; ++layer) {
            layers.first_voxel[layer] = before;
            before += static_cast<std::uint32_t>(std::popcount(near.occupied[layer]));
          }
        }
      }
    }
  }

  // Of all voxels whose index differs from `centre`, one of the middle block, by at most `radius` on each axis.
  [[nodiscard]] Moments around(const VoxelIndex& centre, int radius) const {
    const Eigen::Array3i low = (centre - corner_).array() - radius + kBlockSize;  // in the 24 voxels of three blocks
    const Eigen::Array3i high = low + 2 * radius;
    Moments sum;
    for (int bz = low.z() >> kBlockShift; bz <= high.z() >> kBlockShift; ++bz) {
      for (int by = low.y() >> kBlockShift; by <= high.y() >> kBlockShift; ++by) {
        const std::uint64_t rows = 0x0101010101010101ULL & span(low.y(), high.y(), by, 8);
        for (int bx = low.x() >> kBlockShift; bx <= high.x() >> kBlockShift; ++bx) {
          const int number = bx + 3 * (by + 3 * bz);
          const Layers& block = layers_[static_cast<std::size_t>(number)];
          if (block.occupied == nullptr) continue;
          const std::uint64_t mask = rows * (span(low.x(), high.x(), bx, 1) & 0xFF);
          const int first = std::max(low.z() - bz * kBlockSize, 0);
          const int last = std::min(high.z() - bz * kBlockSize, kBlockSize - 1);
          for (int z = first; z <= last; ++z) add_layer(block, static_cast<std::size_t>(z), mask, sum);
        }
      }
    }
    return sum;
  }

 private:
  struct Layers {
    const std::array<std::uint64_t, kBlockSize>* occupied = nullptr;
    std::array<std::uint32_t, kBlockSize> first_voxel{};
  };

  // Bits [from, to) of 64, each of `width`, where from..to is what block number `block` has of low..high.
  static std::uint64_t span(int low, int high, int block, int width) {
    const int from = std::max(low - block * kBlockSize, 0) * width;
    const int to = std::min(high - block * kBlockSize + 1, kBlockSize) * width;
    return (~std::uint64_t{0} >> (64 - (to - from))) << from;
  }

  void add_layer(const Layers& block, std::size_t z, std::uint64_t mask, Moments& sum) const {
    const std::uint64_t layer = (*block.occupied)[z];
    for (std::uint64_t bits = layer & mask; bits != 0; bits &= bits - 1) {
      const std::uint64_t below = (bits & (~bits + 1)) - 1;
      sum.add(moments_[block.first_voxel[z] + static_cast<std::uint32_t>(std::popcount(layer & below))]);
    }
  }

  const std::vector<Moments>& moments_;
  Eigen::Vector3i corner_;
  std::array<Layers, 27> layers_{};
};

struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float planarity = 0.0F;
};

// Smallest root of x^3 - x^2 + c1 x - c0, which has three in [0, 1] of sum 1. Up to the smallest the polynomial rises
// and is concave, so Newton's steps from 0 never pass it.
double smallest_root(double c1, double c0) {
  constexpr int kMostSteps = 60;  // enough for a double root, to which the steps only halve the way
  double x = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    const double slope = (3.0 * x - 2.0) * x + c1;
    const double next = x - (((x - 1.0) * x + c1) * x - c0) / slope;
    if (!(slope > 0.0) || !(next > x)) break;
    x = next;
  }
  return x;
}

Plane plane_through(const Moments& moments, const Steps& near, const Eigen::Vector3d& view) {
  if (moments.count() < kFewestNeighbours) return {};
  const Eigen::Matrix3d unscaled = scatter_of(moments, near);
  const double trace = unscaled.trace();
  if (!(trace > 0.0)) return {};
  const Eigen::Matrix3d scatter = unscaled * (1.0 / trace);
  const Eigen::Vector3d minors(scatter(1, 1) * scatter(2, 2) - scatter(1, 2) * scatter(1, 2),
                               scatter(0, 0) * scatter(2, 2) - scatter(0, 2) * scatter(0, 2),
                               scatter(0, 0) * scatter(1, 1) - scatter(0, 1) * scatter(0, 1));
  const double least = smallest_root(minors.sum(), scatter.determinant());
  const double rest =
      1.0 - least;  // the sum of the other two eigenvalues; their product is minors.sum() - least * rest
  const double largest = 0.5 * (rest + std::sqrt(std::max(rest * rest - 4.0 * (minors.sum() - least * rest), 0.0)));
  const Eigen::Vector3d spread = Eigen::Vector3d(least, std::max(rest - largest, 0.0), largest).cwiseSqrt();
  if (spread[1] < kLineRatio * spread[2]) return {};
  // Rows of (scatter - least) are normal to its eigenvector; the two that are least parallel say it best.
  const Eigen::Matrix3d rows = scatter - least * Eigen::Matrix3d::Identity();
  Eigen::Vector3d normal = rows.row(0).cross(rows.row(1));
  for (const Eigen::Vector3d& other :
       {Eigen::Vector3d(rows.row(1).cross(rows.row(2))), Eigen::Vector3d(rows.row(2).cross(rows.row(0)))}) {
    if (other.squaredNorm() > normal.squaredNorm()) normal = other;
  }
  if (!(normal.squaredNorm() > 0.0)) return {};
  normal.normalize();
  if (normal.dot(view) < 0.0) normal = -normal;
  return {normal.cast<float>(), static_cast<float>((spread[1] - spread[0]) / spread[2])};
}

}  // namespace

VoxelMap with_surface_normals(const VoxelMap& map) {
  SurfaceVoxels voxels = map.voxels();
  const double per_metre = kStepsPerVoxel / map.resolution_m();
  std::vector<Steps> steps(voxels.size());
  std::vector<Moments> moments(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    steps[i] = steps_of(map.indices()[i], voxels.centroids_m[i], per_metre);
    moments[i] = moments_of(steps[i]);
  }
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count == 0) continue;
    const Neighbourhood near(map, moments, block);
    for (std::size_t i = block.first_voxel; i < block.first_voxel + block.voxel_count; ++i) {
      Moments around = near.around(map.indices()[i], kNearRadius);
      if (around.count() < kEnoughNeighbours) around = near.around(map.indices()[i], kFarRadius);
      const Plane plane = plane_through(around, steps[i], voxels.normals[i].cast<double>());
      voxels.normals[i] = plane.normal;
      voxels.planarity[i] = plane.planarity;
    }
  }
  return {map.resolution_m(), map.has_free_space(), {map.blocks().begin(), map.blocks().end()}, std::move(voxels)};
}

}  // namespace kilter
