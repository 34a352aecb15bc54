// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/pose_table.h"

namespace kilter {

/// Layouts of a file of poses; its content decides, not its name.
enum class PoseLayout { kTum, kKitti, kG2o, kTable };

/// "TUM (t x y z qx qy qz qw)", "KITTI (12 columns)", "g2o", "a table with a heading".
[[nodiscard]] std::string_view name_of(PoseLayout layout);

/// A file of poses of any layout.
struct PoseList : PoseTable {
  PoseLayout layout = PoseLayout::kTum;
  std::vector<std::uint64_t> ids;  ///< a graph's vertices, ascending, one for each pose; else empty
};

/// Which layout the beginning of a file is in; nothing for what holds no poses.
/// \param bytes  the file, or its first few kilobytes
[[nodiscard]] std::optional<PoseLayout> guess_pose_layout(std::string_view bytes);

/// Reads poses T_world_cloud in TUM, KITTI or g2o layout, or from a table with a heading; keeps their stamps.
///
/// A heading behind '#' counts if it names the columns of a pose and the line behind it has as many.
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  at least one pose; or what the reader of its layout fails with (pose_reader.h, g2o_reader.h,
///          pose_table.h). What is in no known layout is read as a table if it begins with a word, else
///          as TUM or KITTI, which says what is wrong with it.
[[nodiscard]] Expected<PoseList> read_pose_list(std::string_view bytes, const std::string& where);

/// The unit of a list's stamps: what its heading says, else what is most likely.
[[nodiscard]] StampUnit stamp_unit_of(const PoseTable& poses);

/// The stamps of a list in nanoseconds, by stamp_unit_of; nothing without stamps, or where one does not fit.
[[nodiscard]] std::optional<std::vector<std::int64_t>> stamps_ns_of(const PoseTable& poses);

}  // namespace kilter
