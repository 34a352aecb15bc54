// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// A pose that its source calls by a number: a vertex of a graph, a frame of a sequence.
struct NumberedPose {
  std::uint64_t id = 0;
  Pose3 T_world_cloud;
};

}  // namespace kilter
