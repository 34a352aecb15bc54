// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/simulation/fault.h"
#include "kilter/simulation/route.h"
#include "kilter/simulation/slam.h"
#include "kilter/simulation/triangle_world.h"

namespace kilter {

/// The robots that a scene can have, each called by one letter.
inline constexpr std::string_view kRobotNames = "abcde";

/// What can be chosen about a world before it is built.
struct SceneOptions {
  std::uint64_t seed = 1;
  double scale = 1.0;  ///< of the world's extent, in [0.5, 10]; furniture keeps its size; 1 in the paper's scenes
  int robots = 2;      ///< 1 to 5, as kRobotNames; 2 in the paper's scenes
};

/// How one robot drives through the world.
struct RobotRoute {
  std::vector<Eigen::Vector3d> corners_m;  ///< points on the ground, world frame
  RouteOptions drive;
  double start_s = 0.0;  ///< when it sets out; moving objects run on this clock
};

/// A world, the robots in it, and how their maps come about.
struct Scene {
  TriangleWorld world;
  std::vector<RobotRoute> routes;  ///< robots a, b, c, ...
  SlamOptions slam;
  std::vector<FaultRequest> faults;  ///< planted unless others are asked for
  double scan_step_m = 0.8;          ///< path between key scans
  double scan_step_rad = 0.6;
  double keep_range_m = 1000.0;  ///< farther returns are thrown away before mapping
};

/// A scene's name and what it is for.
struct SceneInfo {
  std::string_view name;
  std::string_view about;
};

/// All scenes, in the order of the manual.
[[nodiscard]] std::span<const SceneInfo> scene_catalog();

/// Builds a scene. The same options give the same world, bit for bit.
/// \return kInvalidArgument for an unknown name (with the nearest one as hint) or options out of range.
[[nodiscard]] Expected<Scene> make_scene(std::string_view name, const SceneOptions& options);

}  // namespace kilter
