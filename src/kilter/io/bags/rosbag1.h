// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "kilter/io/bags/bag_reader.h"
#include "kilter/io/random_access_file.h"

namespace kilter {

/// What every bag of ROS 1 begins with, the version behind it.
inline constexpr std::string_view kRosbag1Magic = "#ROSBAG V";

/// Reads bags of ROS 1, version 2.0: chunks unpacked, bz2 or lz4, closed or not.
///
/// The file is walked from the front: the index at its end only says which connections there are, and the records
/// behind each chunk which of them it holds, so that chunks without clouds and poses are passed over. A bag that was
/// never closed (.bag.active) or cut short is read as far as its records and chunks are whole.
///
/// \return  a reader whose walk does the reading; or kParse (no bag), kUnsupported (another version, encrypted).
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_rosbag1(RandomAccessFile file);

}  // namespace kilter
