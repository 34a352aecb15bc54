// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/trace_rays.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

using Place = std::tuple<int, int, int>;

std::map<Place, int> take_all(ScanMarks& marks) {
  std::map<Place, int> out;
  marks.take([&](const Eigen::Vector3i& block, std::span<const std::uint8_t, kBlockVoxels> of_block) {
    for (int bit = 0; bit < kBlockVoxels; ++bit) {
      const VoxelIndex at = voxel_of(block, bit);
      if (of_block[static_cast<std::size_t>(bit)] != 0) {
        out[{at.x(), at.y(), at.z()}] = of_block[static_cast<std::size_t>(bit)];
      }
    }
  });
  return out;
}

// Rays of all lengths in all directions, some along axes or planes, some that end where they begin.
RayEnds ragged_rays(Rng& rng, const Eigen::Vector3f& origin_m, int count) {
  RayEnds ends_m;
  ends_m.clear_for(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d direction(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (i % 10 == 0) direction[i / 10 % 3] = 0.0;
    if (i % 40 == 0) direction[(i / 40 + 1) % 3] = 0.0;
    const double length_m = i % 17 == 0 ? 0.02 : rng.uniform(0.1, 8.0);
    Eigen::Vector3f end_m = (origin_m.cast<double>() + direction.normalized() * length_m).cast<float>();
    if (i % 9 == 0) end_m = (end_m * 10.0F).array().round() / 10.0F;
    if (end_m != origin_m) ends_m.add(end_m);
  }
  return ends_m;
}

void open_around(const RayEnds& ends_m, const Eigen::Vector3f& origin_m, double resolution_m, ScanMarks& marks) {
  Eigen::AlignedBox3f box_m(origin_m);
  for (std::size_t i = 0; i < ends_m.count; ++i) box_m.extend(Eigen::Vector3f(ends_m.x[i], ends_m.y[i], ends_m.z[i]));
  marks.begin(block_of(voxel_at(box_m.min().cast<double>(), resolution_m)) - Eigen::Vector3i::Ones(),
              block_of(voxel_at(box_m.max().cast<double>(), resolution_m)) + Eigen::Vector3i::Ones());
}

TEST(TraceRays, EveryPathMarksTheSameVoxels) {
  Rng rng(1, 0);
  for (const int count : {0, 1, 2, 7, 1023, 1024, 1030, 3000}) {
    const Eigen::Vector3f origin_m =
        Eigen::Vector3d(rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-2, 2)).cast<float>();
    const RayEnds ends_m = ragged_rays(rng, origin_m, count);
    const double resolution_m = count % 2 == 0 ? 0.1 : 0.13;
    ScanMarks marks;
    const std::size_t hits = ends_m.count / 2;
    const auto mark_all = [&](const RayKernels& kernels) {
      open_around(ends_m, origin_m, resolution_m, marks);
      kernels.trace(origin_m, ends_m, resolution_m, marks);
      kernels.mark_hits(ends_m, hits, resolution_m, marks);
      return take_all(marks);
    };
    const std::map<Place, int> expected = mark_all(ray_kernels_one_by_one());
    for (const VectorPath path : vector_paths()) {
      EXPECT_TRUE(mark_all(ray_kernels(path)) == expected) << count << " rays, path " << static_cast<int>(path);
    }
  }
}

// Places in the widest window that has a table take more than 32 bits.
TEST(TraceRays, EveryPathMarksTheSameVoxelsInTheWidestWindows) {
  const Eigen::Vector3f origin_m(1.0F, 2.0F, 3.0F);
  RayEnds ends_m;
  ends_m.clear_for(40);
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.16 * i;
    ends_m.add(origin_m + Eigen::Vector3d(190.0 * std::cos(angle), 190.0 * std::sin(angle), i - 20.0).cast<float>());
  }
  ScanMarks marks;
  const auto mark_all = [&](const RayKernels& kernels) {
    open_around(ends_m, origin_m, 0.1, marks);
    kernels.trace(origin_m, ends_m, 0.1, marks);
    return take_all(marks);
  };
  const std::map<Place, int> expected = mark_all(ray_kernels_one_by_one());
  EXPECT_EQ(marks.window().total_bits(), ScanMarks::kMostDenseBits);
  for (const VectorPath path : vector_paths()) {
    EXPECT_TRUE(mark_all(ray_kernels(path)) == expected) << static_cast<int>(path);
  }
}

TEST(ScanMarks, LaterMarksReplaceEarlierOnesAndAreForgottenOnceTaken) {
  ScanMarks marks;
  marks.begin({-2, -1, 0}, {3, 4, 0});
  marks.mark({-16, -8, 0}, ScanMarks::kMiss);
  marks.mark({31, 39, 7}, ScanMarks::kMiss);
  marks.mark({31, 39, 7}, ScanMarks::kHit);
  const std::map<Place, int> expected = {{{-16, -8, 0}, 1}, {{31, 39, 7}, 2}};
  EXPECT_EQ(take_all(marks), expected);
  marks.begin({-100, -100, -100}, {100, 100, 100});
  EXPECT_TRUE(take_all(marks).empty());
}

TEST(ScanMarks, WindowsTooLargeForATableHoldTheSame) {
  ScanMarks marks;
  marks.begin({-100'000, -100'000, -100}, {100'000, 100'000, 100});
  EXPECT_FALSE(marks.is_dense());
  marks.mark({-800'000, 7, -3}, ScanMarks::kHit);
  marks.mark({800'000, 7, -3}, ScanMarks::kMiss);
  const std::map<Place, int> expected = {{{-800'000, 7, -3}, 2}, {{800'000, 7, -3}, 1}};
  EXPECT_EQ(take_all(marks), expected);
}

// Places there would take 66 bits.
TEST(ScanMarks, TheWholeLatticeIsAWindow) {
  constexpr int kLast = kMaxVoxelIndex - 1;
  ScanMarks marks;
  marks.begin(block_of(VoxelIndex::Constant(-kLast)), block_of(VoxelIndex::Constant(kLast)));
  std::map<Place, int> expected;
  for (const int x : {-kLast, 0, kLast}) {
    for (const int y : {-kLast, 0, kLast}) {
      for (const int z : {-kLast, -kLast / 2, 0, kLast}) {
        marks.mark({x, y, z}, ScanMarks::kHit);
        expected[{x, y, z}] = ScanMarks::kHit;
      }
    }
  }
  EXPECT_EQ(take_all(marks), expected);
  marks.begin({-1, -1, -1}, {1, 1, 1});
  EXPECT_TRUE(take_all(marks).empty());
}

}  // namespace
}  // namespace kilter
