// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/numbered_pose.h"
#include "kilter/io/pose_table.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Names of a folder's clouds, bytewise sorted; of one format, that of the first. Hidden files are passed over.
///
/// \return  at least one name; or kEmptyInput, kUnsupported (two formats, a cloud's name on what is no file, files that
///          have to be converted), or what list_folder fails with.
[[nodiscard]] Expected<std::vector<std::string>> list_clouds_of(const std::filesystem::path& folder);

/// Where poses come from, for messages.
struct PoseOrigin {
  std::filesystem::path file;
  std::string_view id_word = "vertex";  ///< what a number in it means: "vertex", "pose"
};

/// When poses were taken, and the unit in which that was written.
struct Stamps {
  std::vector<std::int64_t> ns;
  std::string_view unit;  ///< as RobotLog::stamp_unit
};

/// Gives each cloud whose name is a number ("000012.ply") the pose of that number, in order of the numbers. Clouds
/// without a pose are left out, with a note; poses without a cloud are passed over.
///
/// Fills `log` (poses, counts, reading from files; stamps if given) under the name that it has.
/// \param names   of clouds in `folder`, in any order
/// \param poses   ascending by id
/// \param stamps  none, or one for each pose
/// \return  nothing; or kUnsupported (a name that is no number), kCountMismatch (no cloud has a pose).
[[nodiscard]] Expected<void> pair_by_number(RobotLog& log, const std::filesystem::path& folder,
                                            std::span<const std::string> names, std::span<const NumberedPose> poses,
                                            const Stamps& stamps, const PoseOrigin& origin,
                                            std::vector<std::string>& notes);

/// Sorts names that differ in one number by it, so that scan_2.pcd comes before scan_10.pcd; leaves others as they are.
void sort_by_number(std::vector<std::string>& names);

/// Where clouds and poses pair in order: that a column of names does not contradict it.
/// \param clouds  names of the files, as many as poses
/// \return  nothing; or kCountMismatch with the first that does
[[nodiscard]] Expected<void> check_names(std::span<const std::string> clouds, const PoseTable& poses,
                                         const std::filesystem::path& pose_file);

/// Poses numbered from 0 in their order.
[[nodiscard]] std::vector<NumberedPose> number_from_zero(std::span<const Pose3> poses);

/// A file of stamps, one a line, in nanoseconds by the unit that is most likely. Stamps serve only to tell when clouds
/// were taken, so a file that is missing or is no such list, or has not `count` lines, gives none; a note says so
/// unless the file is missing.
[[nodiscard]] Stamps read_stamps_if_any(const std::filesystem::path& file, std::size_t count, const std::string& robot,
                                        std::vector<std::string>& notes);

/// Gives `log` the stamps of a list of poses, if it has any, and their unit.
void take_stamps(RobotLog& log, const PoseTable& poses);

/// "robot a: poses matched 3 of 5 clouds by stamp; the other 2 are left out".
[[nodiscard]] std::string matched_note(const RobotLog& log, std::string_view by);

/// Poses printed with six digits, as Eigen does by itself, are coarse far from the origin; a note where that reaches
/// a centimetre.
void note_coarse_poses(const RobotLog& log, std::string_view file_name, std::vector<std::string>& notes);

}  // namespace kilter
