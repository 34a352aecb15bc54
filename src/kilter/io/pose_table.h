// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/io/stamp_text.h"

namespace kilter {

/// A list of poses T_world_cloud, one a line, with what else its file tells of each.
struct PoseTable {
  std::vector<Pose3> T_world_cloud;
  std::vector<StampText> stamps;   ///< one for each, or none at all
  std::optional<StampUnit> unit;   ///< of the stamps, where a heading says so
  std::vector<std::string> files;  ///< the cloud's name without folders, for each, or none at all
};

/// Which column of a table is what, by the names in its heading.
struct PoseColumns {
  char separator = ',';           ///< ',', ';', '\t' or ' ' (any blanks)
  std::size_t count = 0;          ///< columns in the heading
  std::vector<std::size_t> pose;  ///< places of x y z qx qy qz qw, from 0
  std::optional<std::size_t> stamp;
  std::optional<std::size_t> nanoseconds;  ///< of a stamp whose seconds are a column of their own, as ROS has it
  std::optional<std::size_t> file;
  std::optional<StampUnit> unit;
};

/// Finds the columns of a pose in a heading, whatever their order: x, tx, px, pos_x, position.x, "p_RS_R_x [m]" for a
/// position, qx, q_x, orientation.x, "q_RS_x []" for a rotation, t, time, stamp, "timestamp [ns]", or secs and nsecs
/// for a stamp, file, filename, cloud for a cloud's name. Capital letters, quotes, a leading '#' or '%' and unknown
/// columns do not matter. \param line  the heading \return  all seven columns of a pose and what else was found; or
/// kParse: which are missing or named twice.
[[nodiscard]] Expected<PoseColumns> parse_heading(std::string_view line);

/// Comments above the rows in which a heading is looked for; no file has more.
inline constexpr std::size_t kMostComments = 256;

/// The heading that a comment is, for rows like `row`: "# timestamp tx ty ...", or behind a colon as in "# format: t x
/// ...". Rows may be cut by another separator than it.
/// \return  nothing where it names no pose, or another number of columns
[[nodiscard]] std::optional<PoseColumns> heading_in_comment(std::string_view comment, std::string_view row);

/// The first of several comments that is one.
[[nodiscard]] std::optional<PoseColumns> heading_in_comments(std::span<const std::string_view> comments,
                                                             std::string_view row);

/// Reads a table of poses whose first line, blank lines and other comments aside, is its heading.
///
/// Comments above the first row may be the heading. Lines that begin with '#' behind it are comments. Memory is bounded
/// by the bytes. \param bytes  the whole file \param where  the file's name, for messages \return  at least one pose;
/// or kParse, kInvalidPose (as pose_reader.h, both with line), kEmptyInput.
[[nodiscard]] Expected<PoseTable> read_pose_table(std::string_view bytes, const std::string& where);

}  // namespace kilter
