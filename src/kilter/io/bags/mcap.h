// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>

#include "kilter/io/bags/bag_reader.h"
#include "kilter/io/random_access_file.h"

namespace kilter {

/// What every MCAP file begins and ends with.
inline constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);

/// Reads MCAP files with messages of ROS 1 or ROS 2: in chunks (unpacked, lz4, zstd) or not, with or without a summary.
///
/// The file is walked from the front. The summary, where there is one, says which channels there are, and the records
/// behind each chunk which of them it holds, so that chunks without clouds and poses are passed over. A file without
/// its end is read as far as its records and chunks are whole.
/// \return  a reader whose walk does the reading; or kParse (no MCAP), kUnsupported (another version).
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_mcap(RandomAccessFile file);

}  // namespace kilter
