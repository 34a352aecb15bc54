// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/pose_graph.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

Vector6 error_of(const PoseGraphEdge& edge, const std::vector<Pose3>& T) {
  return (edge.T_from_to.inverse() * T[edge.from].inverse() * T[edge.to]).log();
}

Vector6 weights_of(const PoseGraphEdge& edge) {
  Vector6 weights;
  weights.head<3>().setConstant(1.0 / (edge.sigma_m * edge.sigma_m));
  weights.tail<3>().setConstant(1.0 / (edge.sigma_rad * edge.sigma_rad));
  return weights;
}

// Normal equations of all nodes but the first, which is held.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t nodes) : gradient_(Eigen::VectorXd::Zero(6 * static_cast<long>(nodes - 1))) {}

  // Perturbing on the right, X <- X Exp(delta): the error moves by delta_to - Ad(T_to_from) delta_from, up to terms
  // of the order of the error itself.
  void add(const PoseGraphEdge& edge, const std::vector<Pose3>& T) {
    const Vector6 error = error_of(edge, T);
    const Vector6 weights = weights_of(edge);
    const Matrix6 J_from = -adjoint(T[edge.to].inverse() * T[edge.from]);
    const Matrix6 W = weights.asDiagonal();
    add_block(edge.to, edge.to, W);
    add_block(edge.from, edge.from, J_from.transpose() * W * J_from);
    add_block(edge.from, edge.to, J_from.transpose() * W);
    add_block(edge.to, edge.from, W * J_from);
    add_gradient(edge.to, weights.cwiseProduct(error));
    add_gradient(edge.from, J_from.transpose() * weights.cwiseProduct(error));
  }

  [[nodiscard]] Expected<Eigen::VectorXd> solve() const {
    SparseMatrix H(gradient_.size(), gradient_.size());
    H.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<SparseMatrix> factor(H);
    if (factor.info() != Eigen::Success || factor.vectorD().minCoeff() <= 0.0) {
      return fail(ErrorCode::kInvalidArgument, "the pose graph does not determine all its poses");
    }
    return Eigen::VectorXd(factor.solve(-gradient_));
  }

 private:
  void add_block(std::size_t row, std::size_t column, const Matrix6& block) {
    if (row == 0 || column == 0) return;
    const auto r = static_cast<int>(6 * (row - 1));
    const auto c = static_cast<int>(6 * (column - 1));
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) entries_.emplace_back(r + i, c + j, block(i, j));
    }
  }
  void add_gradient(std::size_t node, const Vector6& part) {
    if (node > 0) gradient_.segment<6>(6 * static_cast<long>(node - 1)) += part;
  }

  Eigen::VectorXd gradient_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

double pose_graph_cost(const std::vector<PoseGraphEdge>& edges, const std::vector<Pose3>& T_world_node) {
  double cost = 0.0;
  for (const PoseGraphEdge& edge : edges) {
    const Vector6 error = error_of(edge, T_world_node);
    cost += weights_of(edge).dot(error.cwiseProduct(error));
  }
  return cost;
}

Expected<std::vector<Pose3>> relax_pose_graph(const PoseGraph& graph) {
  KILTER_EXPECTS(!graph.T_world_node.empty());
  std::vector<Pose3> T = graph.T_world_node;
  if (T.size() == 1) return T;
  constexpr int kMaxSteps = 50;
  constexpr double kSettled = 1e-7;  // [m], [rad]
  for (int step = 0; step < kMaxSteps; ++step) {
    NormalEquations equations(T.size());
    for (const PoseGraphEdge& edge : graph.edges) equations.add(edge, T);
    const Expected<Eigen::VectorXd> delta = equations.solve();
    if (!delta) return pass_up(delta.error());
    for (std::size_t i = 1; i < T.size(); ++i) {
      T[i] = T[i] * Pose3::exp(delta->segment<6>(6 * static_cast<long>(i - 1)));
    }
    if (delta->cwiseAbs().maxCoeff() < kSettled) return T;
  }
  return fail(ErrorCode::kInvalidArgument, "the pose graph did not settle after 50 steps");
}

}  // namespace kilter
