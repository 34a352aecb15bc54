// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/trace_rays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "kilter/base/vector_target.h"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace kilter {
namespace {

constexpr double kNever = std::numeric_limits<double>::max();

// What all rays of a scan share.
struct Fan {
  Eigen::Vector3f origin_m;
  double resolution_m;
  double per_metre;
  VoxelIndex first;          // the origin's voxel
  Eigen::Vector3d ahead_m;   // from the origin to its voxel's upper border, and
  Eigen::Vector3d behind_m;  // to its lower one

  Fan(const Eigen::Vector3f& origin, double resolution)
      : origin_m(origin),
        resolution_m(resolution),
        per_metre(1.0 / resolution),
        first(voxel_at(origin.cast<double>(), resolution)) {
    for (int axis = 0; axis < 3; ++axis) {
      const double centre_m = (first[axis] + 0.5) * resolution;
      ahead_m[axis] = centre_m + static_cast<float>(resolution * 0.5) - origin[axis];
      behind_m[axis] = centre_m + static_cast<float>(-resolution * 0.5) - origin[axis];
    }
  }
};

// Rays are taken in chunks, so that neighbours stay together, and by length in each, so that those that share a
// register end at about the same time.
constexpr std::size_t kChunk = 1024;
constexpr std::size_t kMostLanes = 8;
constexpr std::size_t kMostTogether = 16;

struct Chunk {
  float x[kChunk + kMostTogether];
  float y[kChunk + kMostTogether];
  float z[kChunk + kMostTogether];
  float length_m[kChunk + kMostTogether];
  int count = 0;
};

// What a register's worth of rays needs to walk, each lane its own; see trace_lanes.inc.
struct Lanes {
  double next_m[3][kMostLanes];   // way to the next border, by axis
  double delta_m[3][kMostLanes];  // and from border to border
  double length_m[kMostLanes];
  std::uint64_t last[kMostLanes];  // place of the last voxel
  std::uint64_t flip[kMostLanes];  // the bits of all axes on which the ray goes down
};

// What is known of a chunk's rays before they are sorted.
struct Unsorted {
  float length_m[kChunk + kMostLanes];
  std::int32_t steps[kChunk + kMostLanes];  // from the origin's voxel
};

// Sorts rays [first, first + count) of the scan by how many steps they take into `rays`, without those that end where
// they begin.
void sort_chunk(const RayEnds& ends_m, std::size_t first, std::size_t count, const Unsorted& known, Chunk& rays) {
  const std::int32_t most = *std::max_element(known.steps, known.steps + count);
  constexpr int kBuckets = 256;
  const int shift = std::max(static_cast<int>(std::bit_width(static_cast<std::uint32_t>(most))) - 8, 0);
  std::array<std::uint32_t, kBuckets + 1> begins{};
  for (std::size_t i = 0; i < count; ++i) {
    begins[static_cast<std::size_t>(known.steps[i] >> shift) + 1] += known.steps[i] != 0;
  }
  for (std::size_t b = 0; b < kBuckets; ++b) begins[b + 1] += begins[b];
  rays.count = static_cast<int>(begins[kBuckets]);
  for (std::size_t i = 0; i < count; ++i) {
    if (known.steps[i] == 0) continue;
    const std::size_t to = begins[static_cast<std::size_t>(known.steps[i] >> shift)]++;
    rays.x[to] = ends_m.x[first + i];
    rays.y[to] = ends_m.y[first + i];
    rays.z[to] = ends_m.z[first + i];
    rays.length_m[to] = known.length_m[i];
  }
  // What is left of the last register repeats the last ray: marks are the same.
  if (rays.count == 0) return;
  for (float* const column : {rays.x, rays.y, rays.z, rays.length_m}) {
    std::fill_n(column + rays.count, kMostTogether, column[rays.count - 1]);
  }
}

}  // namespace

#if defined(__x86_64__)
KILTER_BEGIN_TARGET("avx2")
namespace avx2 {
#include "kilter/occupancy/trace_rays_avx2.inc"
}  // namespace avx2
KILTER_END_TARGET

KILTER_BEGIN_TARGET("avx512f")
namespace avx512 {
#include "kilter/occupancy/trace_rays_avx512.inc"
}  // namespace avx512
KILTER_END_TARGET
#elif defined(__aarch64__)
namespace neon {
#include "kilter/occupancy/trace_rays_neon.inc"
}  // namespace neon
#endif

namespace {

void trace_one(const Fan& fan, const Eigen::Vector3f& end_m, ScanMarks& marks) {
  VoxelIndex voxel = fan.first;
  const VoxelIndex last = voxel_at(end_m.cast<double>(), fan.resolution_m);
  if (voxel == last) return;
  const auto length_m = static_cast<float>(ray_length_m(end_m - fan.origin_m));
  const Eigen::Vector3f direction = (end_m - fan.origin_m) / length_m;
  Eigen::Vector3i step = Eigen::Vector3i::Zero();
  Eigen::Vector3d next_m = Eigen::Vector3d::Constant(kNever);
  Eigen::Vector3d delta_m = next_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0F) continue;
    step[axis] = direction[axis] > 0.0F ? 1 : -1;
    next_m[axis] = (direction[axis] > 0.0F ? fan.ahead_m : fan.behind_m)[axis] / direction[axis];
    delta_m[axis] = fan.resolution_m / std::abs(direction[axis]);
  }
  do {
    marks.mark(voxel, ScanMarks::kMiss);
    const int axis = next_m.x() < next_m.y() ? (next_m.x() < next_m.z() ? 0 : 2) : (next_m.y() < next_m.z() ? 1 : 2);
    voxel[axis] += step[axis];
    next_m[axis] += delta_m[axis];
  } while (voxel != last && next_m.minCoeff() <= length_m);
}

void trace_one_by_one(const Eigen::Vector3f& origin_m, const RayEnds& ends_m, double resolution_m, ScanMarks& marks) {
  const Fan fan(origin_m, resolution_m);
  for (std::size_t i = 0; i < ends_m.count; ++i) trace_one(fan, ends_m[i], marks);
}

void mark_one_by_one(const RayEnds& ends_m, std::size_t count, double resolution_m, ScanMarks& marks) {
  for (std::size_t i = 0; i < count; ++i) {
    marks.mark(voxel_at(ends_m[i].cast<double>(), resolution_m), ScanMarks::kHit);
  }
}

}  // namespace

void RayEnds::clear_for(std::size_t most) {
  count = 0;
  for (std::vector<float>* column : {&x, &y, &z}) column->resize(std::max(column->size(), most + kMostLanes));
}

RayKernels ray_kernels(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return avx512::kKernels;
  if (path == VectorPath::kAvx2) return avx2::kKernels;
#elif defined(__aarch64__)
  if (path == VectorPath::kNeon) return neon::kKernels;
#else
  static_cast<void>(path);
#endif
  return ray_kernels_one_by_one();
}

RayKernels ray_kernels_one_by_one() { return {trace_one_by_one, mark_one_by_one}; }

}  // namespace kilter
