// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/io/mission.h"
#include "testing/cloud_bytes.h"
#include "testing/temp_folder.h"

namespace kilter_testing {

/// A pose that no mistake of order, sign or frame leaves as it is; another one for each i.
inline kilter::Pose3 pose_number(int i) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0 + i, 3.0).normalized();
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.3 + 0.1 * i, axis)), Eigen::Vector3d(1.0 + i, -2.0 * i, 0.5)};
}

/// A cloud of one point that tells which it is: (i + 1, 2, 3).
inline std::string cloud_number(int i) {
  return PcdBytes{.width = "1", .points = "1", .body = fmt::format("{} 2 3\n", i + 1)}.str();
}

/// Columns of a pose as files have them.
inline std::string tum_columns(const kilter::Pose3& T) {
  const Eigen::Vector3d& p = T.translation_m();
  const Eigen::Quaterniond& q = T.rotation();
  return fmt::format("{} {} {} {} {} {} {}", p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

/// Four numbers a line: three lines (KITTI's rows) or, with the last one, four.
inline std::string matrix_rows(const kilter::Pose3& T, int rows = 4, std::string_view line_end = "\n") {
  const Eigen::Matrix4d M = T.isometry().matrix();
  std::string text;
  for (int r = 0; r < rows; ++r) text += fmt::format("{} {} {} {}{}", M(r, 0), M(r, 1), M(r, 2), M(r, 3), line_end);
  return text;
}

/// "VERTEX_SE3:QUAT id x y z qx qy qz qw\n".
inline std::string g2o_vertex(int id, const kilter::Pose3& T) {
  return fmt::format("VERTEX_SE3:QUAT {} {}\n", id, tum_columns(T));
}

inline double difference(const kilter::Pose3& a, const kilter::Pose3& b) { return (a.inverse() * b).log().norm(); }

inline kilter::Expected<kilter::Mission> open_source(const std::filesystem::path& path) {
  return kilter::open_mission({path.string()});
}

inline void expect_source_error(const kilter::Expected<kilter::Mission>& mission, kilter::ErrorCode code,
                                std::string_view message_part) {
  ASSERT_FALSE(mission) << message_part;
  EXPECT_EQ(kilter::error_code_name(mission.error().code), kilter::error_code_name(code))
      << kilter::to_string(mission.error());
  EXPECT_NE(kilter::to_string(mission.error()).find(message_part), std::string::npos)
      << kilter::to_string(mission.error());
}

/// The only robot of a source, which is of the given kind; a failure otherwise.
inline kilter::RobotLog only_robot(const kilter::Expected<kilter::Mission>& mission, std::string_view kind) {
  if (!mission) {
    ADD_FAILURE() << kilter::to_string(mission.error());
    return {};
  }
  EXPECT_EQ(mission->robots.size(), 1U);
  EXPECT_EQ(mission->robots.front().kind, kind);
  return mission->robots.front();
}

/// All notes, one a line.
inline std::string notes_of(const kilter::Expected<kilter::Mission>& mission) {
  std::string text;
  if (mission) {
    for (const std::string& note : mission->notes) text += note + "\n";
  }
  return text;
}

/// The first point of cloud i in the robot's frame of clouds; zero, and a failure, without.
inline Eigen::Vector3f first_point(const kilter::RobotLog& log, std::size_t i) {
  const auto cloud = log.read_cloud(i);
  if (cloud && !cloud->points_m.empty()) return cloud->points_m.front();
  ADD_FAILURE() << (cloud ? "no point" : kilter::to_string(cloud.error()));
  return Eigen::Vector3f::Zero();
}

}  // namespace kilter_testing
