// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"

namespace kilter {

/// What a SLAM back end knows about two poses: T_from_to was measured, with these independent errors.
struct PoseGraphEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose3 T_from_to;
  double sigma_m = 0.01;
  double sigma_rad = 0.001;
};

/// Poses in one world frame and what was measured between them. Node 0 stays where it is.
struct PoseGraph {
  std::vector<Pose3> T_world_node;
  std::vector<PoseGraphEdge> edges;
};

/// The poses that agree best with all edges: minimises the sum of squared log(T_measured^-1 T_from_to), each
/// component over its sigma, by Gauss-Newton with a sparse Cholesky factorisation.
///
/// Every node must be tied to node 0 by a chain of edges.
/// \return  poses in the order of the nodes, or kInvalidArgument when they are not determined or do not settle.
[[nodiscard]] Expected<std::vector<Pose3>> relax_pose_graph(const PoseGraph& graph);

/// Sum of squared, weighted errors, as minimised by `relax_pose_graph`.
[[nodiscard]] double pose_graph_cost(const std::vector<PoseGraphEdge>& edges, const std::vector<Pose3>& T_world_node);

}  // namespace kilter
