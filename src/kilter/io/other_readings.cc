// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/other_readings.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <numbers>

#include "kilter/base/expected.h"

namespace kilter {
namespace {

constexpr int kMostClouds = 10;  // that a list of poses may be ahead or behind
constexpr std::size_t kMostOthers = 20;
constexpr int kYawStep_deg = 10;  // finer mountings are found from the nearest of these
constexpr double kDegrees = 180.0 / std::numbers::pi;

// The 48 ways to call three axes x, y and z, by their directions as columns: first the one that changes nothing, then
// those that leave more axes where they are.
std::vector<Eigen::Matrix3d> ways_to_name_axes() {
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}}};
  std::vector<Eigen::Matrix3d> ways;
  for (const auto& order : kOrders) {
    for (unsigned signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) axes(order[static_cast<std::size_t>(k)], k) = (signs >> k & 1U) != 0 ? -1.0 : 1.0;
      ways.push_back(axes);
    }
  }
  return ways;
}

// Such as "-y, x, z".
std::string names_of(const Eigen::Matrix3d& axes) {
  std::string names;
  for (int k = 0; k < 3; ++k) {
    Eigen::Index row = 0;
    axes.col(k).cwiseAbs().maxCoeff(&row);
    names += fmt::format("{}{}{}", k == 0 ? "" : ", ", axes(row, k) < 0.0 ? "-" : "", "xyz"[row]);
  }
  return names;
}

// The other robots, those first that have about as many clouds; of hundreds some.
std::vector<std::size_t> likely_exchanged(std::span<const RobotLog> robots, std::size_t place) {
  const auto clouds = [&](std::size_t k) { return static_cast<std::int64_t>(robots[k].T_world_cloud.size()); };
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    if (k != place) others.push_back(k);
  }
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(clouds(a) - clouds(place)) < std::abs(clouds(b) - clouds(place));
  });
  others.resize(std::min(others.size(), kMostOthers));
  return others;
}

bool keeps_z(const Eigen::Matrix3d& axes) { return axes(2, 2) > 0.5; }

void add_shifts(const std::vector<Pose3>& poses, std::vector<Reading>& readings) {
  for (int n = 1; n <= kMostClouds; ++n) {
    for (const int by : {n, -n}) {
      readings.push_back(
          {PoseReading::kShifted,
           fmt::format("under the poses of {} cloud{} {}", n, n == 1 ? "" : "s", by > 0 ? "later" : "before"),
           [&poses, by](std::size_t i) -> std::optional<Pose3> {
             const std::int64_t at = static_cast<std::int64_t>(i) + by;
             if (at < 0 || at >= static_cast<std::int64_t>(poses.size())) return std::nullopt;
             return poses[static_cast<std::size_t>(at)];
           }});
    }
  }
}

// Other names for the axes of all, first where z stays, then for those of positions alone. `T_body_sensor` does not
// apply to finished submaps.
void add_axes(const RobotLog& robot, std::vector<Reading>& readings) {
  const std::vector<Pose3>& poses = robot.T_world_cloud;
  const std::vector<Eigen::Matrix3d> ways = ways_to_name_axes();
  for (const bool is_level : {true, false}) {
    for (const Eigen::Matrix3d& axes : ways) {
      if (keeps_z(axes) != is_level) continue;
      if (axes.determinant() < 0.0) {
        readings.push_back({PoseReading::kMirrored, fmt::format("with axes read as ({})", names_of(axes)),
                            [&poses, axes](std::size_t i) { return with_axes(poses[i], axes); }});
      } else if (!is_level && !robot.finished_submaps) {
        readings.push_back(turned_reading(robot, axes));
      }
    }
  }
  for (const Eigen::Matrix3d& axes : ways) {
    if (axes.isIdentity()) continue;
    readings.push_back({PoseReading::kOtherAxes,
                        fmt::format("with positions read as ({}) and rotations as they are", names_of(axes)),
                        [&poses, axes](std::size_t i) {
                          return Pose3(poses[i].rotation(), axes.transpose() * poses[i].translation_m());
                        }});
  }
}

}  // namespace

Pose3 with_axes(const Pose3& T, const Eigen::Matrix3d& axes) {
  const Eigen::Matrix3d R = axes.transpose() * T.rotation_matrix() * axes;
  return {Eigen::Quaterniond(R), axes.transpose() * T.translation_m()};
}

Reading turned_reading(const RobotLog& robot, const Eigen::Matrix3d& R_body_sensor) {
  const Eigen::AngleAxisd turn(R_body_sensor);
  const Eigen::Quaterniond q(R_body_sensor);
  const Eigen::Vector3d& axis = turn.axis();
  Eigen::Index main = 0;
  const bool is_plain = axis.cwiseAbs().maxCoeff(&main) > 0.999;
  const std::string about = is_plain ? fmt::format("{}{}", axis[main] < 0.0 ? "-" : "", "xyz"[main])
                                     : fmt::format("({:.2f} {:.2f} {:.2f})", axis.x(), axis.y(), axis.z());
  return {PoseReading::kTurned,
          fmt::format("with their sensor turned by {:.0f} degrees about {} (qx qy qz qw: {:.3f} {:.3f} {:.3f} {:.3f})",
                      kDegrees * turn.angle(), about, q.x(), q.y(), q.z(), q.w()),
          [&robot, R_body_sensor](std::size_t i) { return with_axes(robot.T_world_cloud[i], R_body_sensor); },
          R_body_sensor};
}

std::vector<Reading> other_readings(std::span<const RobotLog> robots, std::size_t place) {
  const RobotLog& robot = robots[place];
  const std::vector<Pose3>& poses = robot.T_world_cloud;
  std::vector<Reading> readings;
  readings.push_back(
      {PoseReading::kInverse, "with inverted poses", [&](std::size_t i) { return poses[i].inverse(); }, {}});
  readings.push_back({PoseReading::kTransposed, "with transposed rotations",
                      [&](std::size_t i) { return Pose3(poses[i].rotation().conjugate(), poses[i].translation_m()); }});
  readings.push_back({PoseReading::kScalarFirst, "with quaternions read as qw qx qy qz", [&](std::size_t i) {
                        const Eigen::Quaterniond& q = poses[i].rotation();
                        return Pose3(Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), poses[i].translation_m());
                      }});
  for (const std::size_t k : likely_exchanged(robots, place)) {
    readings.push_back({PoseReading::kOtherRobot,
                        fmt::format("under the poses of {}", printable(robots[k].name)),
                        [&theirs = robots[k].T_world_cloud](std::size_t i) {
                          return i < theirs.size() ? std::optional(theirs[i]) : std::nullopt;
                        },
                        {}});
  }
  if (!robot.finished_submaps) {
    add_shifts(poses, readings);
    for (int yaw_deg = kYawStep_deg; yaw_deg < 360; yaw_deg += kYawStep_deg) {
      const Eigen::AngleAxisd yaw(yaw_deg / kDegrees, Eigen::Vector3d::UnitZ());
      readings.push_back(turned_reading(robot, yaw.toRotationMatrix()));
    }
  }
  add_axes(robot, readings);
  return readings;
}

}  // namespace kilter
