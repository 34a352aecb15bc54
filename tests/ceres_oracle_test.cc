// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// constraints.g2o read back and optimised with Ceres, as g2o, GTSAM and Ceres' own example each take an edge: the same
// poses have to come out. Built only where libceres is there; the program never links it.
#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/report/constraints_g2o.h"
#include "testing/results.h"

namespace kilter {
namespace {

constexpr int kSubmaps = 5;

template <typename T>
struct Pose {
  Eigen::Quaternion<T> rotation;
  Eigen::Matrix<T, 3, 1> position;

  [[nodiscard]] Pose inverse() const { return {rotation.conjugate(), -(rotation.conjugate() * position)}; }
  [[nodiscard]] Pose operator*(const Pose& child) const {
    return {rotation * child.rotation, rotation * child.position + position};
  }
};

template <typename T>
Eigen::Matrix<T, 3, 1> vector_of(const Eigen::Quaternion<T>& q) {
  return q.w() < T(0.0) ? Eigen::Matrix<T, 3, 1>(-q.vec()) : Eigen::Matrix<T, 3, 1>(q.vec());
}

// The rotation vector; for turns well below half a circle.
template <typename T>
Eigen::Matrix<T, 3, 1> rotation_vector(const Eigen::Quaternion<T>& q) {
  const Eigen::Matrix<T, 3, 1> v = vector_of(q);
  const T square = v.squaredNorm();
  // asin(x) / x to the sixth order: the derivative of a root at zero is not finite.
  return v * (T(2.0) + square / T(3.0) + T(3.0 / 20.0) * square * square + T(5.0 / 56.0) * square * square * square);
}

// V(w)^-1 t of SE(3)'s logarithm, to the second order of w.
template <typename T>
Eigen::Matrix<T, 3, 1> logarithm_position(const Eigen::Matrix<T, 3, 1>& w, const Eigen::Matrix<T, 3, 1>& t) {
  return t - T(0.5) * w.cross(t) + T(1.0 / 12.0) * w.cross(w.cross(t));
}

template <typename T>
Eigen::Matrix<T, 6, 1> error_of(G2oDialect dialect, const Pose<T>& measured, const Pose<T>& estimated) {
  Eigen::Matrix<T, 6, 1> error;
  const Pose<T> difference = measured.inverse() * estimated;
  switch (dialect) {
    case G2oDialect::kG2o:  // g2o::internal::toVectorMQT(measured^-1 estimated)
      error << difference.position, vector_of(difference.rotation);
      break;
    case G2oDialect::kGtsam: {  // Pose3::Logmap; its parser swaps the blocks of error and information alike
      const Eigen::Matrix<T, 3, 1> w = rotation_vector(difference.rotation);
      error << logarithm_position<T>(w, difference.position), w;
      break;
    }
    case G2oDialect::kCeres: {  // PoseGraph3dErrorTerm
      const Eigen::Quaternion<T> turn = measured.rotation * estimated.rotation.conjugate();
      error << estimated.position - measured.position, T(2.0) * vector_of(turn);
      break;
    }
  }
  return error;
}

struct Edge {
  int target = 0;
  int source = 0;
  Pose<double> measured;
  Matrix6 information;
};

// One edge's error times the root of its information.
struct EdgeCost {
  G2oDialect dialect;
  Edge edge;
  Matrix6 root;

  template <typename T>
  bool operator()(const T* target, const T* source, T* residuals) const {
    const auto pose_of = [](const T* p) {
      return Pose<T>{Eigen::Quaternion<T>(p[6], p[3], p[4], p[5]), Eigen::Matrix<T, 3, 1>(p[0], p[1], p[2])};
    };
    const Pose<T> measured{edge.measured.rotation.cast<T>(), edge.measured.position.cast<T>()};
    const Pose<T> estimated = pose_of(target).inverse() * pose_of(source);
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residuals);
    out = root.cast<T>() * error_of<T>(dialect, measured, estimated);
    return true;
  }
};

using Numbers = std::array<double, 7>;  // x y z qx qy qz qw

// What the file says.
struct Graph {
  std::vector<Numbers> poses;
  std::vector<Edge> edges;
};

Graph read(const std::string& text) {
  Graph graph;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string tag;
    words >> tag;
    if (tag == "VERTEX_SE3:QUAT") {
      int id = 0;
      words >> id;
      Numbers& pose = graph.poses.emplace_back();
      for (double& number : pose) words >> number;
    } else if (tag == "EDGE_SE3:QUAT") {
      Edge& edge = graph.edges.emplace_back();
      Numbers pose{};
      words >> edge.target >> edge.source;
      for (double& number : pose) words >> number;
      edge.measured = {Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]), {pose[0], pose[1], pose[2]}};
      for (int row = 0; row < 6; ++row) {
        for (int column = row; column < 6; ++column) {
          words >> edge.information(row, column);
          edge.information(column, row) = edge.information(row, column);
        }
      }
    }
  }
  return graph;
}

// The poses that the file settles on when its edges are taken as `reader` takes them; the first is held.
std::vector<Pose3> optimise(const std::string& text, G2oDialect reader) {
  Graph graph = read(text);
  ceres::Problem problem;
  using Manifold = ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>;
  for (Numbers& pose : graph.poses) problem.AddParameterBlock(pose.data(), 7, new Manifold());
  problem.SetParameterBlockConstant(graph.poses.front().data());
  for (const Edge& edge : graph.edges) {
    // Ceres' example takes the lower factor (ceres-solver/ceres-solver#449).
    const Eigen::LLT<Matrix6> factors(edge.information);
    const Matrix6 root = reader == G2oDialect::kCeres ? Matrix6(factors.matrixL()) : Matrix6(factors.matrixU());
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeCost, 6, 7, 7>(new EdgeCost{reader, edge, root}),
                             nullptr, graph.poses[static_cast<std::size_t>(edge.target)].data(),
                             graph.poses[static_cast<std::size_t>(edge.source)].data());
  }
  ceres::Solver::Options options;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE) << summary.BriefReport();
  std::vector<Pose3> poses;
  for (const Numbers& p : graph.poses) {
    poses.emplace_back(Eigen::Quaterniond(p[6], p[3], p[4], p[5]), Eigen::Vector3d(p[0], p[1], p[2]));
  }
  return poses;
}

// Five submaps on a bent path, edges between neighbours and across, which contradict each other by a centimetre or two;
// their covariances are dense and unlike each other.
Result graph_result() {
  Rng rng(7, 0);
  Result result = testing::result_of({{"a", kSubmaps}});
  std::vector<Pose3> truth;
  for (int k = 0; k < kSubmaps; ++k) {
    Vector6 step;
    step << 4.0, 0.5 * k, 0.2, 0.1, -0.05 * k, 0.7;
    truth.push_back(k == 0 ? Pose3() : truth.back() * Pose3::exp(step));
    result.submaps[static_cast<std::size_t>(k)].T_world_submap = truth.back();
  }
  for (const auto& [source, target] : {std::pair(1, 0), {2, 1}, {3, 2}, {4, 3}, {2, 0}, {4, 1}, {4, 0}}) {
    PairResult& pair = testing::add_measured_pair(result, source, target);
    Vector6 apart;
    for (double& entry : apart) entry = rng.normal();
    apart.head<3>() *= 0.01;
    apart.tail<3>() *= 0.002;
    pair.T_target_source_registered =
        truth[static_cast<std::size_t>(target)].inverse() * truth[static_cast<std::size_t>(source)] * Pose3::exp(apart);
    Matrix6 root;
    for (double& entry : root.reshaped()) entry = rng.normal();
    Vector6 scale;
    scale << 0.01, 0.01, 0.01, 0.002, 0.002, 0.002;
    pair.covariance = scale.asDiagonal() * (root * root.transpose() + 0.1 * Matrix6::Identity()) * scale.asDiagonal();
    pair.trusted = true;
  }
  return result;
}

// Largest displacement of a submap's origin, or of a place 10 m from it. [m]
double apart_m(const std::vector<Pose3>& a, const std::vector<Pose3>& b) {
  double largest_m = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Pose3 difference = a[k].inverse() * b[k];
    largest_m = std::max(largest_m, difference.translation_m().norm() + 10.0 * difference.angle_rad());
  }
  return largest_m;
}

TEST(CeresOracle, TheSameGraphSettlesOnTheSamePosesInEveryDialect) {
  const Result result = graph_result();
  const std::vector<Pose3> reference = optimise(constraints_g2o(result, G2oDialect::kGtsam), G2oDialect::kGtsam);
  std::vector<Pose3> before;
  for (const SubmapSummary& submap : result.submaps) before.push_back(submap.T_world_submap);
  EXPECT_GT(apart_m(before, reference), 0.02) << "the edges ask for something";
  for (const G2oDialect dialect : {G2oDialect::kG2o, G2oDialect::kCeres}) {
    EXPECT_LT(apart_m(optimise(constraints_g2o(result, dialect), dialect), reference), 1e-3)
        << static_cast<int>(dialect);
  }
}

TEST(CeresOracle, AnotherReadersFileIsNotTheSame) {
  const Result result = graph_result();
  const std::vector<Pose3> reference = optimise(constraints_g2o(result, G2oDialect::kGtsam), G2oDialect::kGtsam);
  for (const G2oDialect written : {G2oDialect::kG2o, G2oDialect::kGtsam, G2oDialect::kCeres}) {
    for (const G2oDialect read : {G2oDialect::kG2o, G2oDialect::kGtsam, G2oDialect::kCeres}) {
      if (written == read) continue;
      EXPECT_GT(apart_m(optimise(constraints_g2o(result, written), read), reference), 3e-3)
          << static_cast<int>(written) << " read as " << static_cast<int>(read);
    }
  }
}

}  // namespace
}  // namespace kilter
