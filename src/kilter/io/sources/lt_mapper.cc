// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/lt_mapper.h"

#include <fmt/format.h>

#include "kilter/io/file.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/sources/cloud_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

struct SessionPoses {
  std::vector<NumberedPose> poses;
  PoseOrigin origin;
};

Expected<SessionPoses> read_session_poses(const SourceRequest& request, std::vector<std::string>& notes) {
  const fs::path optimized = request.path / "optimized_poses.txt";
  if (is_file(optimized)) {
    const auto poses = read_pose_file(optimized);
    if (!poses) return pass_up(poses.error());
    return SessionPoses{number_from_zero(poses->T_world_cloud), {optimized, "pose"}};
  }
  const fs::path graph = request.path / "singlesession_posegraph.g2o";
  const auto bytes = read_file(graph, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  auto vertices = read_g2o_vertices(bytes->view(), shown(graph));
  if (!vertices) return pass_up(vertices.error());
  notes.push_back(fmt::format(
      "robot {}: optimized_poses.txt is not there, so the vertices of {} serve; SC-LIO-SAM writes them as they were "
      "before loops were closed",
      request.name, shown(graph.filename())));
  return SessionPoses{*std::move(vertices), {graph, "vertex"}};
}

}  // namespace

bool is_lt_mapper_session(const fs::path& folder) {
  return is_folder(folder / "Scans") &&
         (is_file(folder / "optimized_poses.txt") || is_file(folder / "singlesession_posegraph.g2o"));
}

Expected<RobotLog> open_lt_mapper_session(const SourceRequest& request, std::vector<std::string>& notes) {
  const fs::path scans = request.path / "Scans";
  const auto names = list_clouds_of(scans);
  if (!names) return pass_up(names.error());
  const Expected<SessionPoses> session = read_session_poses(request, notes);
  if (!session) return pass_up(session.error());
  RobotLog log;
  log.name = request.name;
  const Stamps stamps = read_stamps_if_any(request.path / "times.txt", session->poses.size(), log.name, notes);
  if (auto ok = pair_by_number(log, scans, *names, session->poses, stamps, session->origin, notes); !ok)
    return pass_up(ok.error());
  return log;
}

}  // namespace kilter
