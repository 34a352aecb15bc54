// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kilter {

/// Twist (x y z rx ry rz): translation part [m] first, rotation part [rad].
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A rigid transform T_parent_child: p_parent = T_parent_child * p_child.
class Pose3 {
 public:
  Pose3() = default;
  Pose3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m)
      : rotation_(rotation.normalized()), translation_m_(translation_m) {}

  [[nodiscard]] static Pose3 from_translation(double x, double y, double z) {
    return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, y, z)};
  }

  /// Exponential map of SE(3). `xi` = (x y z rx ry rz).
  [[nodiscard]] static Pose3 exp(const Vector6& xi);

  /// Inverse of exp; rotation angle in [0, pi].
  [[nodiscard]] Vector6 log() const;

  [[nodiscard]] const Eigen::Quaterniond& rotation() const { return rotation_; }
  [[nodiscard]] const Eigen::Vector3d& translation_m() const { return translation_m_; }
  [[nodiscard]] Eigen::Matrix3d rotation_matrix() const { return rotation_.toRotationMatrix(); }
  [[nodiscard]] Eigen::Isometry3d isometry() const;

  /// Rotation angle in [0, pi]. [rad]
  [[nodiscard]] double angle_rad() const;

  [[nodiscard]] Pose3 inverse() const;
  [[nodiscard]] Pose3 operator*(const Pose3& child) const;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& point_m) const {
    return rotation_ * point_m + translation_m_;
  }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_m_ = Eigen::Vector3d::Zero();
};

/// The matrix that turns a cross product into a product: skew(a) * b = a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Adjoint of T for twists (translation first): T * Exp(xi) = Exp(Ad xi) * T.
[[nodiscard]] Matrix6 adjoint(const Pose3& T);

}  // namespace kilter
