// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/geometry/pose3.h"

#include <cmath>

namespace kilter {
namespace {

// Left Jacobian of SO(3), V = I + (1 - cos a)/a^2 [w] + (a - sin a)/a^3 [w]^2, by series near zero.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const double angle2 = omega.squaredNorm();
  const double angle = std::sqrt(angle2);
  double b = 0.5 - angle2 / 24.0;
  double c = 1.0 / 6.0 - angle2 / 120.0;
  if (angle > 1e-3) {
    const double half_sine = std::sin(0.5 * angle);
    b = 2.0 * half_sine * half_sine / angle2;
    c = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Eigen::Matrix3d W = skew(omega);
  return Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double norm = v.norm();
  const double w = sign * rotation.w();
  if (norm < 1e-12) return 2.0 * v / w;
  return (2.0 * std::atan2(norm, w) / norm) * v;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Pose3 Pose3::exp(const Vector6& xi) {
  const Eigen::Vector3d omega = xi.tail<3>();
  const double half = 0.5 * omega.norm();
  const double sinc_half = half < 1e-6 ? 0.5 - half * half / 12.0 : 0.5 * std::sin(half) / half;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(half);
  rotation.vec() = sinc_half * omega;
  return {rotation, left_jacobian(omega) * xi.head<3>()};
}

Vector6 Pose3::log() const {
  const Eigen::Vector3d omega = rotation_vector(rotation_);
  Vector6 xi;
  xi.head<3>() = left_jacobian(omega).inverse() * translation_m_;
  xi.tail<3>() = omega;
  return xi;
}

Eigen::Isometry3d Pose3::isometry() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_matrix();
  T.translation() = translation_m_;
  return T;
}

double Pose3::angle_rad() const { return 2.0 * std::atan2(rotation_.vec().norm(), std::abs(rotation_.w())); }

Pose3 Pose3::inverse() const {
  const Eigen::Quaterniond back = rotation_.conjugate();
  return {back, -(back * translation_m_)};
}

Pose3 Pose3::operator*(const Pose3& child) const {
  return {rotation_ * child.rotation_, rotation_ * child.translation_m_ + translation_m_};
}

Matrix6 adjoint(const Pose3& T) {
  const Eigen::Matrix3d R = T.rotation_matrix();
  Matrix6 ad = Matrix6::Zero();
  ad.topLeftCorner<3, 3>() = R;
  ad.bottomRightCorner<3, 3>() = R;
  ad.topRightCorner<3, 3>() = skew(T.translation_m()) * R;
  return ad;
}

}  // namespace kilter
