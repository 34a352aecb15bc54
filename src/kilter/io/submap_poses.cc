// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/submap_poses.h"

#include <fmt/format.h>

#include <cstddef>

#include "kilter/io/file.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/pose_file.h"

namespace kilter {
namespace {

// A submap's clouds in its robot's log.
struct Part {
  std::size_t robot;
  ScanRange clouds;
  std::string name;  // "a/1"
};

std::string name_of(const RobotLog& robot, std::size_t submap) {
  return printable(fmt::format("{}/{}", robot.name, submap + 1));
}

Expected<std::vector<Part>> parts_of(const std::vector<RobotLog>& robots, const Cuts& cuts, const std::string& where) {
  std::vector<Part> parts;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::size_t clouds = robots[r].T_world_cloud.size();
    if (robots[r].finished_submaps) {
      for (std::size_t k = 0; k < clouds; ++k) parts.push_back({r, {k, k}, name_of(robots[r], k)});
      continue;
    }
    const auto cut = cuts.find(robots[r].name);
    if (cut == cuts.end()) {
      return fail(ErrorCode::kCountMismatch,
                  fmt::format("has poses of submaps, but where robot {} was cut into them is not known",
                              printable(robots[r].name)),
                  where, "give the result whose constraints were optimised by --cuts RESULT");
    }
    if (cut->second.empty() || cut->second.back().last + 1 != clouds) {
      return fail(ErrorCode::kCountMismatch,
                  fmt::format("--cuts knows {} scans of robot {}, but there are {}",
                              cut->second.empty() ? 0 : cut->second.back().last + 1, printable(robots[r].name), clouds),
                  where, "give the scans that the result was made from");
    }
    for (std::size_t k = 0; k < cut->second.size(); ++k) {
      parts.push_back({r, cut->second[k], name_of(robots[r], k)});
    }
  }
  return parts;
}

// A graph of another result may have as many vertices; where its comments name them, that tells.
Expected<void> check_names(std::string_view bytes, const std::vector<Part>& parts, const std::string& where) {
  for (const auto& [id, name] : g2o_vertex_names(bytes)) {
    const std::string& here = parts[id].name;
    if (printable(name) == here) continue;
    return fail(ErrorCode::kCountMismatch,
                fmt::format("vertex {} is called {}, but that submap here is {}", id, printable(name), here), where,
                "give a graph of this map's submaps, with the --cuts of the result that it comes from");
  }
  return {};
}

}  // namespace

Expected<std::vector<SubmapMove>> move_submaps(std::string_view bytes, const std::string& where, const Cuts& cuts,
                                               std::vector<RobotLog>& robots) {
  const Expected<std::vector<NumberedPose>> vertices = read_g2o_vertices(bytes, where);
  if (!vertices) return pass_up(vertices.error());
  const Expected<std::vector<Part>> parts = parts_of(robots, cuts, where);
  if (!parts) return pass_up(parts.error());
  // They are in order of their ids and none is there twice.
  if (vertices->size() != parts->size() || vertices->back().id + 1 != parts->size()) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("{} vertices, the last with id {}, but there are {} submaps", vertices->size(),
                            vertices->back().id, parts->size()),
                where, "one vertex for each submap, with the ids of constraints.g2o, from 0");
  }
  if (auto fit = check_names(bytes, *parts, where); !fit) return pass_up(fit.error());
  std::vector<SubmapMove> moves;
  for (std::size_t i = 0; i < parts->size(); ++i) {
    const auto& [robot, clouds, name] = (*parts)[i];
    std::vector<Pose3>& T_world_cloud = robots[robot].T_world_cloud;
    const Pose3& T_world_vertex = (*vertices)[i].T_world_cloud;
    const Pose3& T_world_submap = T_world_cloud[clouds.first];
    moves.push_back({(T_world_vertex.translation_m() - T_world_submap.translation_m()).norm(),
                     T_world_vertex.rotation().angularDistance(T_world_submap.rotation())});
    const Pose3 moved = T_world_vertex * T_world_submap.inverse();
    for (std::size_t k = clouds.first; k <= clouds.last; ++k) T_world_cloud[k] = moved * T_world_cloud[k];
  }
  return moves;
}

Expected<std::vector<SubmapMove>> move_submaps(const std::filesystem::path& graph, const Cuts& cuts,
                                               std::vector<RobotLog>& robots) {
  const auto bytes = read_file(graph, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  return move_submaps(bytes->view(), shown(graph), cuts, robots);
}

}  // namespace kilter
