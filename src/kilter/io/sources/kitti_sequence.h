// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Reads `Tr:` of a KITTI odometry calib.txt, T_cam0_velodyne: twelve numbers, the rows of a 3x4 matrix. Other lines
/// are passed over. \return  the pose, or kParse, kInvalidPose, with the line; kNotFound (no such line).
[[nodiscard]] Expected<Pose3> parse_kitti_calibration(std::string_view bytes, const std::string& where);

/// Whether a folder holds velodyne/ beside calib.txt, poses.txt or times.txt.
[[nodiscard]] bool is_kitti_sequence(const std::filesystem::path& folder);

/// A sequence of the KITTI odometry benchmark, or one laid out like it (SemanticKITTI): velodyne/000000.bin ..., each
/// at the pose of its number in poses.txt, or in ../../poses/NAME.txt, where NAME is the sequence's folder.
///
/// Those poses are of the left camera (z forward, y down). They become T_world_velo = Tr^-1 * T_cam0 * Tr, with the
/// first scan's frame as world: x forward, z up. \return  one scan for each file with a pose; stamps from times.txt if
/// it has as many lines as there are poses. Or
///          kNotFound (no calib.txt, no poses), kEmptyInput, kCountMismatch, or what the readers fail with.
[[nodiscard]] Expected<RobotLog> open_kitti_sequence(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
