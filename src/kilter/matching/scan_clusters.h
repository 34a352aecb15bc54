// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kilter/base/vector_path.h"

namespace kilter {

/// Lanes of the widest register.
inline constexpr std::uint32_t kMostLanes = 16;

/// Points as columns, those of one cluster (a few that lie near each other) side by side, with room behind the last one
/// so that whole registers can be read from any of them. A point's number is where it stands.
class ClusteredPoints {
 public:
  static constexpr float kNowhere = 1e18F;  // what stands there: its square is finite and beyond any limit
  static constexpr std::int32_t kNoNumber = std::numeric_limits<std::int32_t>::max();

  ClusteredPoints() = default;
  explicit ClusteredPoints(std::size_t count)
      : x(count + kMostLanes, kNowhere), y(count + kMostLanes, kNowhere), z(count + kMostLanes, kNowhere) {}
  [[nodiscard]] std::size_t bytes() const { return x.size() * 3 * sizeof(float); }

  std::vector<float> x, y, z;
};

/// The points of a cluster and the box around them.
struct Cluster {
  std::array<float, 3> low_m{};
  std::array<float, 3> high_m{};
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

/// Clusters whose points stand one after the other, as columns of their boxes, with room behind the last one so that
/// whole registers can be read from any of them.
class ClusterBoxes {
 public:
  ClusterBoxes() = default;
  /// Room for so many, which hold so many points.
  ClusterBoxes(std::size_t clusters, std::uint32_t points);
  /// Precondition: there is room; its points begin where those of the last one end.
  void add(const Cluster& cluster) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_m[axis][size_] = cluster.low_m[axis];
      high_m[axis][size_] = cluster.high_m[axis];
    }
    first[size_++] = cluster.first;
  }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] Cluster operator[](std::size_t k) const {
    return {
        {low_m[0][k], low_m[1][k], low_m[2][k]}, {high_m[0][k], high_m[1][k], high_m[2][k]}, first[k], first[k + 1]};
  }
  [[nodiscard]] std::size_t bytes() const {
    return low_m[0].size() * 6 * sizeof(float) + first.size() * sizeof(std::uint32_t);
  }

  std::array<std::vector<float>, 3> low_m;
  std::array<std::vector<float>, 3> high_m;
  std::vector<std::uint32_t> first;  ///< point of each cluster; one more for where the last one ends

 private:
  std::uint32_t size_ = 0;
};

/// Squares of distances to boxes are multiplied by this: floats are never more wrong.
inline constexpr float kRoundedDown = 0.999F;

/// A box along the axes. [m]
struct FloatBox {
  std::array<float, 3> low_m{};
  std::array<float, 3> high_m{};

  /// To the cluster's box; 0 where they meet. [m^2]
  [[nodiscard]] float square_gap_m2(const Cluster& cluster) const;
};

/// Up to kMostLanes clusters, a lane for each; out of reach where there is none.
class ClusterGroup {
 public:
  using Floats = std::array<float, kMostLanes>;

  /// \param least  nobody who asks is nearer to any of them. [m^2]
  explicit ClusterGroup(float least);
  void add(const Cluster& cluster);
  /// Cluster k of columns.
  void add(const ClusterBoxes& boxes, std::size_t k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_m[axis][size_] = boxes.low_m[axis][k];
      high_m[axis][size_] = boxes.high_m[axis][k];
    }
    first[size_] = boxes.first[k];
    end[size_] = boxes.first[k + 1];
    ++size_;
  }
  [[nodiscard]] bool full() const { return size_ == kMostLanes; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

  alignas(64) std::array<Floats, 3> low_m{};
  std::array<Floats, 3> high_m{};
  std::array<std::uint32_t, kMostLanes> first{};
  std::array<std::uint32_t, kMostLanes> end{};
  float least_m2;

 private:
  std::uint32_t size_ = 0;
};

/// The nearest point found so far: its number (kNoNumber: none yet) and the squared distance, or the squared limit.
struct NearestPoint {
  float square_m2 = 0.0F;
  std::int32_t number = ClusteredPoints::kNoNumber;
};

/// Looks through clusters for a point nearer to `point` than `best`, or as near with a lower number. Groups are in
/// order of their least distances.
using ScanClusters = void (*)(const ClusteredPoints& points, std::span<const ClusterGroup> groups, const float* point,
                              NearestPoint& best);

/// All of them do the same operations on each point in the same precision, so that the answer is the same to the bit.
[[nodiscard]] ScanClusters scan_clusters_with(VectorPath path);

}  // namespace kilter
