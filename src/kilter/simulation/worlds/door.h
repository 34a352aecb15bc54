// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kilter/simulation/scene.h"

namespace kilter {

enum class DoorHabit {
  kAutomatic,     ///< opens for a robot and closes behind it
  kOpensForGood,  ///< is closed until the first robot comes
  kClosesAtLast,  ///< is open until the first robot has passed
};

/// A door or gate across a way.
struct DoorPlace {
  Eigen::Vector2d at_m;   ///< its middle
  Eigen::Vector2d along;  ///< the way through it; any length
  double width_m = 2.0;
  DoorHabit habit = DoorHabit::kAutomatic;
  double opens_at_m = 0.5;  ///< a robot nearer than this opens it
};

/// Adds doors to the scene's moving objects. They open for the scene's routes, which must be complete.
void hang_doors(const std::vector<DoorPlace>& places, double height_m, Scene& scene);

}  // namespace kilter
