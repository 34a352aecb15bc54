// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <string_view>

namespace kilter {

/// A submap's place in the global numbering: all of the first robot, then the second, ... (robots sorted bytewise).
/// 0-based; the outside sees robot name and 1-based index.
struct SubmapId {
  int value = 0;
  auto operator<=>(const SubmapId&) const = default;
};

/// A directed pair: voxels of `source` are brought into the frame of `target`. Row = source, column = target, so
/// with target < source matrices are lower triangular. Ordered row by row.
struct PairId {
  SubmapId source;
  SubmapId target;
  auto operator<=>(const PairId&) const = default;
};

/// The seed's three kinds of pairs (Eq. 4-6).
enum class PairKind {
  kSequential,  ///< (i, i-1) of one robot
  kLocal,       ///< (i, j) of one robot, i - j >= local_min_gap
  kGlobal,      ///< two robots
};

[[nodiscard]] constexpr std::string_view to_string(PairKind kind) {
  switch (kind) {
    case PairKind::kSequential:
      return "sequential";
    case PairKind::kLocal:
      return "local";
    case PairKind::kGlobal:
      return "global";
  }
  return "";
}

}  // namespace kilter
