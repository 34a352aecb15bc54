// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kilter {

/// A stamp as it was written, before its unit is known. No digit is lost to a double.
struct StampText {
  std::int64_t whole = 0;       ///< before the point, >= 0
  std::int64_t billionths = 0;  ///< behind the point, 0 to 999'999'999
  bool has_point = false;       ///< "12.0" rather than "12"
  bool operator==(const StampText&) const = default;
};

enum class StampUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

/// "s", "ms", "us", "ns".
[[nodiscard]] std::string_view symbol_of(StampUnit unit);

/// "1403636579.763555584", "1403636579763555584", "1.4e9". Nothing for what is no such number, negative or too large.
[[nodiscard]] std::optional<StampText> parse_stamp_text(std::string_view word);

/// The stamp in a cloud's name, behind letters if there are any: of "1403636579.763555.pcd", "1403636579_763555584.pcd"
/// (seconds, nanoseconds) or "cloud_12.5.ply". Also takes mere numbers ("000012.pcd").
[[nodiscard]] std::optional<StampText> stamp_of_file(std::string_view name);

/// Whether numbers can hardly count clouds: some have a point and go by as scans come (most of them a millisecond or
/// more apart), or lie where clocks stand since 2001.
[[nodiscard]] bool look_like_stamps(std::span<const StampText> stamps);

/// The unit in which stamps, in order, most likely stand: the one that makes them Unix times of this century in
/// plausible steps; else, for clocks that begin at zero, the one that makes steps plausible.
[[nodiscard]] StampUnit guess_unit(std::span<const StampText> stamps);

/// In nanoseconds; nothing where one does not fit.
[[nodiscard]] std::optional<std::vector<std::int64_t>> to_nanoseconds(std::span<const StampText> stamps,
                                                                      StampUnit unit);

/// "1403636579.763 to 1403636600.100, in s": smallest and largest, as written. At least one.
[[nodiscard]] std::string range_of(std::span<const StampText> stamps, StampUnit unit);

}  // namespace kilter
