// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "kilter/io/bags/bag_reader.h"

namespace kilter {

/// Reads a .db3 file of ROS 2: tables `topics` and `messages`.
///
/// Opened read-only and immutable, so that nothing is written beside it, with SQLite's guards against hostile files.
/// What a recorder that was killed left in FILE-wal is not read, and a note says so.
///
/// \return  a reader whose walk does the reading; or kNotFound, kIo, kParse (no SQLite database, damaged, or without
///          the two tables).
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_rosbag2_sqlite(const std::filesystem::path& path);

}  // namespace kilter
