// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// What kilter takes from a key frame's file `data`.
struct HdlKeyFrame {
  std::optional<Pose3> estimate;    ///< T_map_sensor after optimisation
  std::optional<Pose3> odom;        ///< T_odom_sensor, as the odometry had it
  std::optional<std::uint64_t> id;  ///< of its vertex in graph.g2o
  std::optional<std::int64_t> stamp_ns;
};

/// Reads a key frame's file `data`: words `stamp sec nsec`, `id n`, and `estimate`, `odom` each above a 4x4 matrix;
/// other lines are passed over, and of two with one word the first counts. \return  what was there; or what take_matrix
/// fails with.
[[nodiscard]] Expected<HdlKeyFrame> parse_hdl_key_frame(std::string_view bytes, const std::string& where);

/// Whether a folder holds a numbered folder with a file `data` and a `cloud.pcd`.
[[nodiscard]] bool is_hdl_dump(const std::filesystem::path& folder);

/// A dump of hdl_graph_slam, mrg_slam or interactive_slam: the key frames' scans, each at its `estimate`. Where one has
/// none, its vertex in graph.g2o serves; where that is missing too, `odom` serves for all key frames, with a note.
///
/// \return  one scan for each key frame, in order of the folders' numbers; or kEmptyInput, kNotFound (a key frame
/// without
///          cloud.pcd), kParse (neither estimate nor odom for all), kInvalidPose and what read_file fails with.
[[nodiscard]] Expected<RobotLog> open_hdl_dump(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
