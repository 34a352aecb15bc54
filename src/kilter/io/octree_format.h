// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace kilter {

/// The two files that OctoMap writes; the first line tells, whatever the file is called.
enum class OctreeFormat {
  kFull,    ///< `.ot`: a float log-odds and a byte of children for every node
  kBinary,  ///< `.bt`: two bits for every child of an inner node: unknown, free, occupied or with children
};

/// The levels below the root of any OctoMap tree: 16 bits an axis.
inline constexpr int kOctreeLevels = 16;

inline constexpr std::string_view kFullOctreeLine = "# Octomap OcTree file";
inline constexpr std::string_view kBinaryOctreeLine = "# Octomap OcTree binary file";

}  // namespace kilter
