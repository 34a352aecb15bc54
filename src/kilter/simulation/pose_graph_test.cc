// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

Pose3 planar(double x, double y, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), Eigen::Vector3d(x, y, 0.0)};
}

Pose3 shaken(const Pose3& T, double deviation, Rng& rng) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = deviation * rng.normal();
  return T * Pose3::exp(xi);
}

std::vector<Pose3> ring(std::size_t count) {
  std::vector<Pose3> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    poses.push_back(planar(10.0 * std::cos(angle), 10.0 * std::sin(angle), angle));
  }
  return poses;
}

TEST(PoseGraph, FindsTheTruthThatItsEdgesWereMadeFrom) {
  const std::vector<Pose3> truth = ring(40);
  Rng rng(1, 0);
  PoseGraph graph;
  for (const Pose3& T : truth) graph.T_world_node.push_back(shaken(T, 0.2, rng));
  graph.T_world_node[0] = truth[0];
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::size_t next = (i + 1) % truth.size();
    graph.edges.push_back({i, next, truth[i].inverse() * truth[next]});
  }
  const auto relaxed = relax_pose_graph(graph);
  ASSERT_TRUE(relaxed.has_value());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((truth[i].inverse() * (*relaxed)[i]).log().norm(), 1e-6);
}

TEST(PoseGraph, SpreadsAGapEvenlyOverAChain) {
  PoseGraph graph;
  for (std::size_t i = 0; i <= 10; ++i) graph.T_world_node.push_back(planar(static_cast<double>(i), 0.0, 0.0));
  for (std::size_t i = 0; i < 10; ++i) graph.edges.push_back({i, i + 1, planar(1.0, 0.0, 0.0)});
  graph.edges.push_back({0, 10, planar(11.0, 0.0, 0.0), 1e-6, 1e-6});
  const auto relaxed = relax_pose_graph(graph);
  ASSERT_TRUE(relaxed.has_value());
  for (std::size_t i = 0; i <= 10; ++i) {
    EXPECT_NEAR((*relaxed)[i].translation_m().x(), 1.1 * static_cast<double>(i), 1e-6);
  }
}

TEST(PoseGraph, NoNeighbouringSolutionIsCheaper) {
  const std::vector<Pose3> truth = ring(12);
  Rng rng(5, 0);
  PoseGraph graph{truth, {}};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::size_t next = (i + 1) % truth.size();
    graph.edges.push_back({i, next, shaken(truth[i].inverse() * truth[next], 0.01, rng), 0.01, 0.01});
  }
  const std::vector<Pose3> best = *relax_pose_graph(graph);
  const double cost = pose_graph_cost(graph.edges, best);
  EXPECT_GT(cost, 0.0);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Pose3> other = best;
    const std::size_t node = 1 + rng.below(truth.size() - 1);
    other[node] = shaken(other[node], 0.002, rng);
    EXPECT_GT(pose_graph_cost(graph.edges, other), cost);
  }
}

TEST(PoseGraph, RefusesPosesThatNothingTies) {
  PoseGraph graph{ring(3), {}};
  graph.edges.push_back({0, 1, planar(1.0, 0.0, 0.0)});
  const auto relaxed = relax_pose_graph(graph);
  ASSERT_FALSE(relaxed.has_value());
  EXPECT_EQ(relaxed.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace kilter
