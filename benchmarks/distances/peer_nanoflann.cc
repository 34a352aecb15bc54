// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nanoflann.hpp>

#include "methods.h"

namespace kilter {
namespace {

struct Points {
  const std::vector<Eigen::Vector3f>& points_m;

  // nanoflann calls these by their names.
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points_m.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points_m[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

struct State {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3>;
  Points points;
  Tree tree;
  explicit State(const Side& side) : points{side.points_m}, tree(3, points, {10}) {}
};

float distance_of(State& state, const Eigen::Vector3f& at_m) {
  std::uint32_t index = 0;
  float square_m2 = 0.0F;
  nanoflann::KNNResultSet<float, std::uint32_t> nearest(1);
  nearest.init(&index, &square_m2);
  square_m2 = static_cast<float>(kLimit_m * kLimit_m);  // nothing farther is looked at
  state.tree.findNeighbors(nearest, at_m.data(), {});
  return nearest.size() == 0 ? kNone : std::sqrt(square_m2);
}

}  // namespace

Method by_nanoflann(const Side& source, const Side& target) {
  return point_by_point<State>("nanoflann", source, target, distance_of);
}

}  // namespace kilter
