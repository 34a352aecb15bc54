// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "kilter/simulation/scene.h"

namespace kilter {

/// The worlds behind `make_scene`; one file each. Options are in range.
[[nodiscard]] Scene make_office(const SceneOptions& options);
[[nodiscard]] Scene make_carpark(const SceneOptions& options);
[[nodiscard]] Scene make_warehouse(const SceneOptions& options);
[[nodiscard]] Scene make_tunnel(const SceneOptions& options, bool niches);
[[nodiscard]] Scene make_stairs(const SceneOptions& options);
[[nodiscard]] Scene make_forest(const SceneOptions& options);
[[nodiscard]] Scene make_village(const SceneOptions& options);
[[nodiscard]] Scene make_factory(const SceneOptions& options);
[[nodiscard]] Scene make_paper_indoor(const SceneOptions& options);
[[nodiscard]] Scene make_paper_outdoor(const SceneOptions& options);

/// Random numbers for one part of a world, so that changing one part leaves the others as they were.
enum class WorldPart : std::uint64_t { kPlan = 1, kFurniture, kStreet, kPlants, kTraffic, kRoutes };
[[nodiscard]] inline Rng part_rng(const SceneOptions& options, WorldPart part) {
  return {options.seed, static_cast<std::uint64_t>(part)};
}

/// Gives each route its own sway and the robots staggered starts.
void finish_routes(Scene& scene, const SceneOptions& options, const RouteOptions& drive);

}  // namespace kilter
