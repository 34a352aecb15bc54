// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Which of N submaps could show one place: boxes in an R-tree, then coarse occupancy through the relative pose. Before
// any time is printed the boxes that meet are held against those of every submap with every other.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "../processor_clock.h"
#include "kilter/pairing/propose_pairs.h"
#include "testing/scenes.h"

namespace {

constexpr int kRounds = 5;
constexpr int kSubmapsOfRobot = 100;
constexpr double kBetweenSubmaps_m = 5.0;
constexpr double kBetweenRobots_m = 18.0;
constexpr std::size_t kMostComparedAll = 2000;

struct Mission {
  std::vector<kilter::SubmapNode> nodes;
  std::vector<kilter::CoarseMap> maps;
};

// Robots side by side, each along a line; all see the same kind of room.
Mission mission_of(std::size_t count, const kilter::CoarseMap& room) {
  Mission mission;
  for (std::size_t i = 0; i < count; ++i) {
    kilter::SubmapNode node;
    node.id = {static_cast<int>(i)};
    node.robot = static_cast<int>(i) / kSubmapsOfRobot;
    node.index = static_cast<int>(i) % kSubmapsOfRobot;
    node.path_start_m = kBetweenSubmaps_m * node.index;
    node.path_end_m = node.path_start_m + kBetweenSubmaps_m;
    node.T_world_submap =
        kilter::testing::pose_at(node.path_start_m, kBetweenRobots_m * node.robot, 0.0, 0.1 * node.index);
    mission.nodes.push_back(std::move(node));
  }
  mission.maps.assign(count, room);
  return mission;
}

double median_seconds(int rounds, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int round = 0; round < rounds; ++round) {
    const double start = processor_seconds();
    work();
    seconds.push_back(processor_seconds() - start);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

// Every submap with every other: what the tree has to find.
std::size_t count_by_force(const Mission& mission, const kilter::PairingOptions& options) {
  std::vector<Eigen::AlignedBox3d> boxes_m;
  for (const kilter::SubmapNode& node : mission.nodes) {
    const auto number = static_cast<std::size_t>(node.id.value);
    boxes_m.push_back(kilter::moved_box(mission.maps[number].bounds_m(), node.T_world_submap));
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes_m.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const kilter::SubmapNode& source = mission.nodes[i];
      const kilter::SubmapNode& target = mission.nodes[j];
      const bool sequential = source.robot == target.robot && source.index == target.index + 1;
      Eigen::AlignedBox3d wide_m = boxes_m[i];
      const double by_m = options.max_distance_m + kilter::drift_allowance_m(source, target, options);
      wide_m.min().array() -= by_m;
      wide_m.max().array() += by_m;
      count += sequential || wide_m.intersects(boxes_m[j]) ? 1 : 0;
    }
  }
  return count;
}

void print_row(std::size_t count, const kilter::CoarseMap& room) {
  const Mission mission = mission_of(count, room);
  const kilter::PairingOptions options;
  std::vector<kilter::CandidatePair> pairs = kilter::meeting_pairs(mission.nodes, mission.maps, options);
  if (count <= kMostComparedAll && pairs.size() != count_by_force(mission, options)) {
    fmt::print(stderr, "{} submaps: {} pairs, {} by trying them all\n", count, pairs.size(),
               count_by_force(mission, options));
    std::exit(1);
  }
  const double meeting_s =
      median_seconds(kRounds, [&] { pairs = kilter::meeting_pairs(mission.nodes, mission.maps, options); });
  const double all_s =
      median_seconds(1, [&] { pairs = kilter::propose_pairs(mission.nodes, mission.maps, options, {}); });
  const auto n = static_cast<double>(count);
  const auto found = static_cast<double>(pairs.size());
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", count, pairs.size(), found / n, 1e6 * meeting_s / n,
             1e6 * (all_s - meeting_s) / found, all_s);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<kilter::Pose3> poses = {kilter::testing::pose_at(4.0, 3.0, 1.2, 0.0)};
  const kilter::Submap submap = kilter::testing::submap_of(kilter::testing::furnished_room(), poses, poses[0], 1);
  const kilter::CoarseMap room(submap.map, kilter::kMaxCoarseCells);
  fmt::print(
      "| submaps | pairs | pairs a submap | boxes that meet, us a submap | coarse overlap, us a pair | all, s |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- |\n");
  for (int k = 1; k < argc; ++k) print_row(std::stoul(argv[k]), room);
  return 0;
}
