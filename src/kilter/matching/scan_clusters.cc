// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_clusters.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kilter/matching/cluster_gaps.h"

namespace kilter {
namespace {

constexpr float kSlack_m2 = 1e-6F;

// The nearest point of each lane. Written once for any number of lanes; each caller's target decides which registers
// they become.
template <std::uint32_t kLanes>
struct NearestOfLanes {
  typename Register<kLanes>::Floats square_m2{};
  typename Register<kLanes>::Ints number{};
};

template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void keep_nearer(const NearestOfLanes<kLanes>& found, NearestOfLanes<kLanes>& best) {
  const typename Register<kLanes>::Ints lower = found.number < best.number ? found.number : best.number;
  const typename Register<kLanes>::Ints as_near = found.square_m2 == best.square_m2 ? lower : best.number;
  best.number = found.square_m2 < best.square_m2 ? found.number : as_near;
  best.square_m2 = found.square_m2 < best.square_m2 ? found.square_m2 : best.square_m2;
}

template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void keep_nearest(const NearestOfLanes<kLanes>& lanes, NearestPoint& best) {
  if constexpr (kLanes > 4) {
    std::array<NearestOfLanes<kLanes / 2>, 2> halves;
    for (std::size_t half = 0; half < 2; ++half) {
      const std::size_t bytes = sizeof(halves[half].square_m2);
      std::memcpy(&halves[half].square_m2, reinterpret_cast<const char*>(&lanes.square_m2) + half * bytes, bytes);
      std::memcpy(&halves[half].number, reinterpret_cast<const char*>(&lanes.number) + half * bytes, bytes);
    }
    keep_nearer(halves[1], halves[0]);
    keep_nearest(halves[0], best);
  } else {
    NearestOfLanes<4> least = lanes;
    keep_nearer<4>({__builtin_shufflevector(least.square_m2, least.square_m2, 2, 3, 0, 1),
                    __builtin_shufflevector(least.number, least.number, 2, 3, 0, 1)},
                   least);
    keep_nearer<4>({__builtin_shufflevector(least.square_m2, least.square_m2, 1, 0, 3, 2),
                    __builtin_shufflevector(least.number, least.number, 1, 0, 3, 2)},
                   least);
    best = {least.square_m2[0], least.number[0]};
  }
}

// A bit for each box that may hold something as near as `within_m2`.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline std::uint32_t near_boxes(const ClusterGroup& group, const float* point, float within_m2) {
  using Floats = typename Register<kLanes>::Floats;
  using Ints = typename Register<kLanes>::Ints;
  Ints near{};
  for (std::uint32_t from = 0; from < kMostLanes; from += kLanes) {
    Floats square;
    square_gaps<kLanes>(group, from, point, point, square);
    Ints bits;
    std::memcpy(&bits, kLaneBits.data() + from, sizeof(bits));
    near |= square <= Floats{} + (within_m2 + kSlack_m2) ? bits : Ints{};
  }
  return any_of<kLanes>(near);
}

template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void scan_boxes(const ClusteredPoints& points, const ClusterGroup& group,
                                              std::uint32_t boxes, const float* point, NearestPoint& best) {
  NearestOfLanes<kLanes> nearest;
  nearest.square_m2 = typename Register<kLanes>::Floats{} + best.square_m2;
  nearest.number = typename Register<kLanes>::Ints{} + best.number;
  typename Register<kLanes>::Ints lanes;
  std::memcpy(&lanes, kLaneNumbers.data(), sizeof(lanes));
  for (; boxes != 0; boxes &= boxes - 1) {
    const auto box = static_cast<std::size_t>(std::countr_zero(boxes));
    for (std::uint32_t i = group.first[box]; i < group.end[box]; i += kLanes) {
      typename Register<kLanes>::Floats dx;
      typename Register<kLanes>::Floats dy;
      typename Register<kLanes>::Floats dz;
      NearestOfLanes<kLanes> found;
      std::memcpy(&dx, points.x.data() + i, sizeof(dx));
      std::memcpy(&dy, points.y.data() + i, sizeof(dy));
      std::memcpy(&dz, points.z.data() + i, sizeof(dz));
      found.number = lanes + static_cast<std::int32_t>(i);
      dx -= point[0];
      dy -= point[1];
      dz -= point[2];
      found.square_m2 = dx * dx + dy * dy + dz * dz;
      keep_nearer(found, nearest);
    }
  }
  keep_nearest(nearest, best);
}

// While nothing is found, one cluster after the other; then all at once that may hold something nearer.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void scan(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                        const float* point, NearestPoint& best) {
  for (const ClusterGroup& group : groups) {
    if (group.least_m2 > best.square_m2) return;
    std::uint32_t near = near_boxes<kLanes>(group, point, best.square_m2);
    while (near != 0) {
      const std::uint32_t now = best.number == ClusteredPoints::kNoNumber ? near & (~near + 1) : near;
      scan_boxes<kLanes>(points, group, now, point, best);
      near &= ~now;
      if (near != 0) near &= near_boxes<kLanes>(group, point, best.square_m2);
    }
  }
}

void scan_baseline(const ClusteredPoints& points, std::span<const ClusterGroup> groups, const float* point,
                   NearestPoint& best) {
  scan<4>(points, groups, point, best);
}

#if defined(__x86_64__)
[[gnu::target("avx2,bmi")]] void scan_avx2(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                           const float* point, NearestPoint& best) {
  scan<8>(points, groups, point, best);
}

[[gnu::target("avx512f,bmi")]] void scan_avx512(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                                const float* point, NearestPoint& best) {
  scan<16>(points, groups, point, best);
}
#endif

}  // namespace

float FloatBox::square_gap_m2(const Cluster& cluster) const {
  float square_m2 = 0.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float gap_m = std::max({cluster.low_m[axis] - high_m[axis], low_m[axis] - cluster.high_m[axis], 0.0F});
    square_m2 += gap_m * gap_m;
  }
  return square_m2;
}

ClusterBoxes::ClusterBoxes(std::size_t clusters, std::uint32_t points) : first(clusters + 1, points) {
  for (std::vector<float>& axis : low_m) axis.assign(clusters + kMostLanes, ClusteredPoints::kNowhere);
  for (std::vector<float>& axis : high_m) axis.assign(clusters + kMostLanes, ClusteredPoints::kNowhere);
}

ClusterGroup::ClusterGroup(float least) : least_m2(least) {
  for (Floats& axis : low_m) axis.fill(ClusteredPoints::kNowhere);
  for (Floats& axis : high_m) axis.fill(ClusteredPoints::kNowhere);
}

void ClusterGroup::add(const Cluster& cluster) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_m[axis][size_] = cluster.low_m[axis];
    high_m[axis][size_] = cluster.high_m[axis];
  }
  first[size_] = cluster.first;
  end[size_] = cluster.end;
  ++size_;
}

ScanClusters scan_clusters_with(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return scan_avx512;
  if (path == VectorPath::kAvx2) return scan_avx2;
#else
  static_cast<void>(path);
#endif
  return scan_baseline;
}

}  // namespace kilter
