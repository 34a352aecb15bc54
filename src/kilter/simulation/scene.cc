// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/scene.h"

#include <fmt/format.h>

#include <array>

#include "kilter/base/option_table.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

constexpr std::array<SceneInfo, 13> kScenes = {{
    {"office", "rooms and corridors in rings; a slip, a frame that is off and a missed closure"},
    {"carpark", "open ground, parked and moving cars, trees, facades, poles"},
    {"warehouse", "shelves that look alike; one aisle is taken for another"},
    {"tunnel", "nothing fixes the direction along it"},
    {"tunnel-niches", "the same with a few niches"},
    {"stairs", "two storeys above each other: overlap in plan, none in space"},
    {"forest", "trunks, leaves and uneven ground"},
    {"village", "houses with gabled roofs, hedges and fences, parked cars; a slip, and a robot that drifts off"},
    {"factory", "machines, tanks, columns and pipes; a missed closure and a slip"},
    {"clean-office", "the office as a good SLAM leaves it: residuals of a few centimetres, no fault"},
    {"clean-carpark", "the car park likewise"},
    {"paper-indoor", "the seed paper's building: robot a closes its loop, robot b does not"},
    {"paper-outdoor", "the seed paper's car park: slips within robots, both misaligned where they meet again"},
}};

constexpr double kOfficeWall_m = 4.0;
constexpr double kCarparkWall_m = 12.0;

// The same world and routes, no fault, and a map as good as SLAM makes it: what was seen twice lies some centimetres
// apart, also where it is as far away as walls mostly are here.
Scene clean(Scene scene, double wall_m) {
  const double lever = kOfficeWall_m / wall_m;  // by which a turn counts less than in an office
  scene.faults.clear();
  scene.slam.closure_sigma_m = 0.02;
  scene.slam.closure_sigma_rad *= lever;
  // It matches whatever it sees again, not only where it drives through the same place.
  scene.slam.closure_distance_m = wall_m;
  scene.slam.closure_spacing_m = 1.0;
  // And its odometry, matched against the map, loses half as much on the way between.
  scene.slam.drift.bias_m_per_m *= 0.5;
  scene.slam.drift.bias_rad_per_m *= 0.5 * lever;
  scene.slam.drift.yaw_rad_per_rad *= 0.5 * lever;
  return scene;
}

std::string nearest_scene(std::string_view name) {
  std::vector<std::string> names;
  names.reserve(kScenes.size());
  for (const SceneInfo& info : kScenes) names.emplace_back(info.name);
  const std::string near = nearest_name(name, names);
  return near.empty() ? "kilter simulate --help lists all scenes" : "did you mean " + near + "?";
}

// The paper's scenes are built for what its figures show, and grow neither in size nor in robots.
Expected<void> check_paper_scene(std::string_view name, const SceneOptions& options) {
  if (options.scale == 1.0 && options.robots == 2) return {};
  const std::string found =
      options.scale != 1.0 ? fmt::format("scale {}", options.scale) : fmt::format("robots {}", options.robots);
  return fail(ErrorCode::kInvalidArgument, fmt::format("{} has its own size and two robots, found {}", name, found), {},
              "leave --scale and --robots out, or choose another scene");
}

}  // namespace

std::span<const SceneInfo> scene_catalog() { return kScenes; }

Expected<Scene> make_scene(std::string_view name, const SceneOptions& options) {
  if (!(options.scale >= 0.5 && options.scale <= 10.0)) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("scale: expected 0.5 to 10, found {}", options.scale));
  }
  if (options.robots < 1 || options.robots > std::ssize(kRobotNames)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("robots: expected 1 to {}, found {}", kRobotNames.size(), options.robots));
  }
  if (name == "paper-indoor" || name == "paper-outdoor") {
    if (Expected<void> fit = check_paper_scene(name, options); !fit) return pass_up(fit.error());
    return name == "paper-indoor" ? make_paper_indoor(options) : make_paper_outdoor(options);
  }
  if (name == "office") return make_office(options);
  if (name == "carpark") return make_carpark(options);
  if (name == "warehouse") return make_warehouse(options);
  if (name == "tunnel") return make_tunnel(options, false);
  if (name == "tunnel-niches") return make_tunnel(options, true);
  if (name == "stairs") return make_stairs(options);
  if (name == "forest") return make_forest(options);
  if (name == "village") return make_village(options);
  if (name == "factory") return make_factory(options);
  if (name == "clean-office") return clean(make_office(options), kOfficeWall_m);
  if (name == "clean-carpark") return clean(make_carpark(options), kCarparkWall_m);
  return fail(ErrorCode::kInvalidArgument, "there is no scene \"" + printable(name) + "\"", {}, nearest_scene(name));
}

void finish_routes(Scene& scene, const SceneOptions& options, const RouteOptions& drive) {
  for (std::size_t r = 0; r < scene.routes.size(); ++r) {
    scene.routes[r].drive = drive;
    scene.routes[r].drive.seed = options.seed * 31 + r;
    scene.routes[r].start_s = 40.0 * static_cast<double>(r);  // sessions one after another would share no traffic
  }
}

}  // namespace kilter
