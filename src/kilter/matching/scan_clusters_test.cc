// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

using Point = std::array<float, 3>;

struct Clusters {
  ClusteredPoints points;
  std::vector<ClusterGroup> groups;
};

// Points on a coarse lattice, so that many are equally near; groups in any order, and so any order of numbers.
Clusters lattice_clusters(std::size_t count, std::uint64_t seed) {
  Rng rng(seed, 0);
  Clusters made{ClusteredPoints(count), {}};
  ClusterGroup group(0.0F);
  for (std::uint32_t first = 0; first < count;) {
    const auto end = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, first + 1 + rng.bits() % 40));
    Cluster cluster{{1e9F, 1e9F, 1e9F}, {-1e9F, -1e9F, -1e9F}, first, end};
    const Point corner = {static_cast<float>(rng.bits() % 7), static_cast<float>(rng.bits() % 7), 0.0F};
    for (std::uint32_t i = first; i < end; ++i) {
      const Point at = {corner[0] + static_cast<float>(rng.bits() % 3), corner[1] + static_cast<float>(rng.bits() % 3),
                        static_cast<float>(rng.bits() % 3)};
      made.points.x[i] = at[0];
      made.points.y[i] = at[1];
      made.points.z[i] = at[2];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cluster.low_m[axis] = std::min(cluster.low_m[axis], at[axis]);
        cluster.high_m[axis] = std::max(cluster.high_m[axis], at[axis]);
      }
    }
    group.add(cluster);
    if (group.full()) {
      made.groups.push_back(group);
      group = ClusterGroup(0.0F);
    }
    first = end;
  }
  if (!group.empty()) made.groups.push_back(group);
  std::reverse(made.groups.begin(), made.groups.end());
  return made;
}

// The definition, one point at a time.
NearestPoint nearest_of(const ClusteredPoints& points, std::size_t count, const Point& at, NearestPoint best) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = points.x[i] - at[0];
    const float dy = points.y[i] - at[1];
    const float dz = points.z[i] - at[2];
    const float square_m2 = dx * dx + dy * dy + dz * dz;
    const auto number = static_cast<std::int32_t>(i);
    const bool is_less = square_m2 < best.square_m2 || (square_m2 == best.square_m2 && number < best.number);
    if (is_less) best = {square_m2, number};
  }
  return best;
}

TEST(ScanClusters, EveryPathFindsTheNearestAndOfEqualsTheLowestNumber) {
  for (const VectorPath path : vector_paths()) {
    const ScanClusters scan = scan_clusters_with(path);
    for (const std::size_t count : {1U, 3U, 4U, 7U, 16U, 17U, 64U, 131U, 700U}) {
      const Clusters clusters = lattice_clusters(count, count);
      Rng rng(9, count);
      for (int k = 0; k < 300; ++k) {
        const Point at = {static_cast<float>(rng.bits() % 20) / 2, static_cast<float>(rng.bits() % 20) / 2,
                          static_cast<float>(rng.bits() % 6) / 2};
        NearestPoint best{static_cast<float>(rng.uniform(0.0, 6.0)), ClusteredPoints::kNoNumber};
        if (k % 3 == 0) best = {2.0F, static_cast<std::int32_t>(rng.bits() % count)};  // a hint
        const NearestPoint expected = nearest_of(clusters.points, count, at, best);
        scan(clusters.points, clusters.groups, at.data(), best);
        ASSERT_EQ(best.number, expected.number) << "path " << static_cast<int>(path) << ", " << count << " points";
        ASSERT_EQ(best.square_m2, expected.square_m2);
      }
    }
  }
}

TEST(ScanClusters, StopsAtGroupsThatAreFartherThanWhatIsFound) {
  Clusters clusters = lattice_clusters(1, 1);
  const Point at = {clusters.points.x[0], clusters.points.y[0], clusters.points.z[0]};
  clusters.groups[0].least_m2 = 4.0F;
  for (const VectorPath path : vector_paths()) {
    NearestPoint best{3.0F, ClusteredPoints::kNoNumber};
    scan_clusters_with(path)(clusters.points, clusters.groups, at.data(), best);
    EXPECT_EQ(best.number, ClusteredPoints::kNoNumber);
  }
}

TEST(ScanClusters, RoomBehindTheLastPointIsNeverNear) {
  Clusters clusters = lattice_clusters(1, 1);
  clusters.points.x[0] = clusters.points.y[0] = clusters.points.z[0] = 100.0F;
  clusters.groups[0].low_m = {};
  const Point at = {0.0F, 0.0F, 0.0F};
  for (const VectorPath path : vector_paths()) {
    NearestPoint best{std::numeric_limits<float>::max(), ClusteredPoints::kNoNumber};
    scan_clusters_with(path)(clusters.points, clusters.groups, at.data(), best);
    EXPECT_EQ(best.number, 0);
  }
}

}  // namespace
}  // namespace kilter
