// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any two texts handed to --submap-poses and --cuts (a null byte between them) leave a mission as it was, with a
// printable reason, or put each submap where its vertex is and keep what lies inside as it lay.
#include <string_view>
#include <utility>
#include <vector>

#include "kilter/io/g2o_reader.h"
#include "kilter/io/submap_poses.h"
#include "reader_laws.h"

namespace {

using kilter::Pose3;
using kilter::RobotLog;

constexpr std::size_t kScans = 6;
constexpr std::size_t kFinished = 2;

RobotLog robot(const char* name, std::size_t clouds) {
  RobotLog log;
  log.name = name;
  for (std::size_t k = 0; k < clouds; ++k) {
    const double x_m = static_cast<double>(k);
    log.T_world_cloud.emplace_back(Eigen::Quaterniond(1.0, 0.0, 0.0, 0.1 * x_m).normalized(),
                                   Eigen::Vector3d(x_m, -x_m, 1.0));
  }
  return log;
}

// One robot that is cut, one that comes as finished submaps.
std::vector<RobotLog> mission() {
  std::vector<RobotLog> robots = {robot("a", kScans), robot("b", kFinished)};
  robots[1].finished_submaps = true;
  return robots;
}

double apart(const Pose3& a, const Pose3& b) {
  const Pose3 moved = a.inverse() * b;
  return moved.translation_m().norm() + moved.angle_rad();
}

void demand_unchanged(const std::vector<RobotLog>& robots) {
  const std::vector<RobotLog> before = mission();
  for (std::size_t r = 0; r < robots.size(); ++r) {
    for (std::size_t k = 0; k < robots[r].T_world_cloud.size(); ++k) {
      const Pose3& now = robots[r].T_world_cloud[k];
      const Pose3& then = before[r].T_world_cloud[k];
      kilter_fuzz::demand(now.translation_m() == then.translation_m());
      kilter_fuzz::demand(now.rotation().coeffs() == then.rotation().coeffs());
    }
  }
}

// Positions of 1e8 m are known to some 1e-8 m.
void demand_moved(const RobotLog& after, const RobotLog& before, kilter::ScanRange clouds,
                  const Pose3& T_world_vertex) {
  const auto& [first, last] = clouds;
  kilter_fuzz::demand(apart(after.T_world_cloud[first], T_world_vertex) < 1e-6);
  for (std::size_t k = first; k <= last; ++k) {
    kilter_fuzz::demand(apart(after.T_world_cloud[first].inverse() * after.T_world_cloud[k],
                              before.T_world_cloud[first].inverse() * before.T_world_cloud[k]) < 1e-6);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view both = kilter_fuzz::text_of(data, size);
  const std::string_view graph = both.substr(0, both.find('\0'));
  kilter::Cuts cuts = {{"a", {{0, 2}, {3, kScans - 1}}}};
  if (graph.size() < both.size()) {
    auto parsed = kilter::parse_cuts(both.substr(graph.size() + 1), "fuzz");
    if (!parsed) return 0;  // cuts_fuzz.cc has its laws
    cuts = *std::move(parsed);
  }
  std::vector<RobotLog> robots = mission();
  const auto moved = kilter::move_submaps(graph, "fuzz", cuts, robots);
  if (!moved) {
    demand_unchanged(robots);
    kilter_fuzz::demand_printable(moved.error());
    return 0;
  }
  const std::vector<RobotLog> before = mission();
  const auto vertices = *kilter::read_g2o_vertices(graph, "fuzz");
  kilter_fuzz::demand(vertices.size() == cuts.at("a").size() + kFinished);
  std::size_t id = 0;
  for (const kilter::ScanRange& clouds : cuts.at("a")) {
    demand_moved(robots[0], before[0], clouds, vertices[id++].T_world_cloud);
  }
  for (std::size_t k = 0; k < kFinished; ++k) {
    demand_moved(robots[1], before[1], {k, k}, vertices[id++].T_world_cloud);
  }
  return 0;
}
