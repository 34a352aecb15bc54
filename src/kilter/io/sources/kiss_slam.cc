// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/kiss_slam.h"

#include <algorithm>
#include <memory>
#include <span>

#include "kilter/base/contract.h"
#include "kilter/io/file.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/sources/cloud_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

fs::path graph_of(const fs::path& folder) { return folder / "local_maps" / "local_map_graph.g2o"; }

// In place. The way back is exact up to a float's rounding, as is the way there.
void move_points(PointCloud& cloud, const Pose3& T_submap_world) {
  const Eigen::Isometry3d T = T_submap_world.isometry();
  for (Eigen::Vector3f& point_m : cloud.points_m) point_m = (T * point_m.cast<double>()).cast<float>();
}

void read_in_own_frames(RobotLog& log) {
  const auto key_poses = std::make_shared<const std::vector<Pose3>>(log.T_world_cloud);
  log.read_cloud = [key_poses, read_world = std::move(log.read_cloud)](std::size_t i) {
    KILTER_EXPECTS(i < key_poses->size());
    Expected<PointCloud> cloud = read_world(i);
    if (cloud) move_points(*cloud, (*key_poses)[i].inverse());
    return cloud;
  };
}

// KISS-SLAM begins the next local map as soon as it has written one, so the last is a vertex without a file.
void drop_unwritten_map(std::vector<NumberedPose>& vertices, std::span<const std::string> names) {
  std::uint64_t last = 0;
  for (const std::string& name : names) last = std::max(last, number_of_file(name).value_or(0));
  if (vertices.size() > 1 && vertices.back().id == last + 1) vertices.pop_back();
}

}  // namespace

bool is_kiss_slam_result(const fs::path& folder) { return is_file(graph_of(folder)); }

Expected<RobotLog> open_kiss_slam_result(const SourceRequest& request, std::vector<std::string>& notes) {
  const fs::path graph = graph_of(request.path);
  const auto bytes = read_file(graph, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  auto vertices = read_g2o_vertices(bytes->view(), shown(graph));
  if (!vertices) return pass_up(vertices.error());
  const fs::path folder = request.path / "local_maps" / "plys";
  const auto names = list_clouds_of(folder);
  if (!names) return pass_up(names.error());
  drop_unwritten_map(*vertices, *names);
  RobotLog log;
  log.name = request.name;
  log.finished_submaps = true;
  if (auto ok = pair_by_number(log, folder, *names, *vertices, {}, {graph, "vertex"}, notes); !ok)
    return pass_up(ok.error());
  read_in_own_frames(log);
  return log;
}

}  // namespace kilter
