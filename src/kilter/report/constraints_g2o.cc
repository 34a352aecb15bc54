// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/constraints_g2o.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <fmt/format.h>

#include "kilter/report/json_writer.h"

namespace kilter {
namespace {

// Of correlations, whose units and size do not count: beyond this ratio of eigenvalues the inverse is mostly rounding.
constexpr double kMinConditionInverse = 1e-13;

std::string pose_text(const Pose3& pose) {
  const Eigen::Vector3d& t = pose.translation_m();
  const Eigen::Quaterniond& q = pose.rotation();
  std::string text;
  for (const double number : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) text += ' ' + number_text(number);
  return text;
}

// The example multiplies errors by the factor L of L L^T = what it reads, and so weighs them with L^T L. What has to
// stand in the file for that to be the information: its factor is the transposed one of U U^T = information.
Matrix6 weighed_by_lower_root(const Matrix6& information) {
  const Matrix6 reversed = information.reverse();
  const Matrix6 factor = reversed.llt().matrixL();
  const Matrix6 U = factor.reverse();
  return U.transpose() * U;
}

std::string edge_text(const Result& result, const PairResult& pair, G2oDialect dialect) {
  const std::string names = fmt::format("{} <- {}", printable(result.submap(pair.id.target).name),
                                        printable(result.submap(pair.id.source).name));
  if (!pair.T_target_source_registered || !pair.covariance) return fmt::format("# {}: no covariance, no edge\n", names);
  const std::optional<Matrix6> information =
      information_for(dialect, *pair.covariance, *pair.T_target_source_registered);
  if (!information) return fmt::format("# {}: covariance cannot be inverted, no edge\n", names);
  std::string text = fmt::format("# {}\nEDGE_SE3:QUAT {} {}{}", names, pair.id.target.value, pair.id.source.value,
                                 pose_text(*pair.T_target_source_registered));
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) text += ' ' + number_text((*information)(row, column));
  }
  return text + '\n';
}

}  // namespace

std::optional<Matrix6> information_for(G2oDialect dialect, const Matrix6& covariance, const Pose3& T_target_source) {
  if (!covariance.allFinite()) return std::nullopt;
  Matrix6 J = Matrix6::Identity();  // d(reader's error) / d xi
  if (dialect == G2oDialect::kG2o) J.bottomRightCorner<3, 3>() *= 0.5;
  if (dialect == G2oDialect::kCeres) {
    const Eigen::Matrix3d R = T_target_source.rotation().toRotationMatrix();
    J.topLeftCorner<3, 3>() = R;
    J.bottomRightCorner<3, 3>() = -R;
  }
  const Matrix6 sigma = J * (0.5 * (covariance + covariance.transpose())) * J.transpose();
  if (!(sigma.diagonal().minCoeff() > 0.0)) return std::nullopt;
  // A turn that nothing fixes about a place far from the origin makes variances of square kilometres beside those of
  // square millimetres, all of them well known.
  const auto scale = sigma.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  const Matrix6 correlations = scale * sigma * scale;
  const Vector6 values = Eigen::SelfAdjointEigenSolver<Matrix6>(correlations, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(values[0] > 0.0) || values[0] < kMinConditionInverse * values[5]) return std::nullopt;
  const Matrix6 inverse = scale * correlations.ldlt().solve(Matrix6(scale));
  const Matrix6 information = 0.5 * (inverse + inverse.transpose());
  const Matrix6 written = dialect == G2oDialect::kCeres ? weighed_by_lower_root(information) : information;
  return written.allFinite() ? std::optional(written) : std::nullopt;
}

std::string submaps_g2o(const std::vector<SubmapSummary>& submaps) {
  std::string text;
  for (const SubmapSummary& submap : submaps) {
    text += fmt::format("# {}\nVERTEX_SE3:QUAT {}{}\n", printable(submap.name), submap.id.value,
                        pose_text(submap.T_world_submap));
  }
  return text;
}

std::string constraints_g2o(const Result& result, G2oDialect dialect) {
  std::string text =
      "# kilter: submaps as vertices, T_world_submap; trusted registrations as edges target source, T_target_source\n";
  switch (dialect) {
    case G2oDialect::kG2o:
      text +=
          "# information for g2o's error (x y z qx qy qz); readers that take rotation vectors see it four times too "
          "strong\n";
      break;
    case G2oDialect::kGtsam:
      text += "# information as GTSAM reads it: (x y z rx ry rz) in the source's frame, rotation vectors\n";
      break;
    case G2oDialect::kCeres:
      text +=
          "# information as Ceres' pose_graph_3d reads it: (x y z -rx -ry -rz) along the target's axes, which it "
          "multiplies by llt().matrixL()\n";
      break;
  }
  text += submaps_g2o(result.submaps);
  for (const PairResult& pair : result.pairs) {
    if (pair.trusted) text += edge_text(result, pair, dialect);
  }
  return text;
}

}  // namespace kilter
