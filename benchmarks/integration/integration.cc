// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Scans into an occupancy map: MapBuilder beside OctoMap's lazy insertPointCloud on the same points with the same
// parameters. The two maps are compared voxel by voxel before any time is printed.
#include <fmt/format.h>
#include <malloc.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "../processor_clock.h"
#include "kilter/io/mission.h"
#include "kilter/occupancy/map_builder.h"

namespace {

using kilter::VectorPath;

constexpr double kResolution_m = 0.1;
constexpr double kMaxRange_m = 60.0;

// What both are given: points and origins in the first scan's frame, as floats, without the robot itself.
struct Scan {
  Eigen::Vector3d origin_m;
  std::vector<Eigen::Vector3d> points_m;
  octomap::Pointcloud cloud;
};

kilter::OccupancyOptions options() {
  return {.resolution_m = kResolution_m, .min_range_m = 0.0, .max_range_m = kMaxRange_m};
}

octomap::point3d origin_of(const Scan& scan) {
  const Eigen::Vector3f origin_m = scan.origin_m.cast<float>();
  return {origin_m.x(), origin_m.y(), origin_m.z()};
}

double seconds(const std::function<void()>& work) {
  const double start = processor_seconds();
  work();
  return processor_seconds() - start;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double megabytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / 1e6;
}

bool read_scans(const std::string& robot, std::size_t first, std::size_t count, std::vector<Scan>& scans) {
  const auto mission = kilter::open_mission({robot});
  if (!mission) {
    fmt::print(stderr, "{}\n", kilter::to_string(mission.error()));
    return false;
  }
  const kilter::RobotLog& log = mission->robots.front();
  if (log.T_world_cloud.size() < first + count) {
    fmt::print(stderr, "{} has fewer than {} scans\n", robot, first + count);
    return false;
  }
  for (std::size_t i = first; i < first + count; ++i) {
    const auto cloud = log.read_cloud(i);
    if (!cloud) {
      fmt::print(stderr, "{}\n", kilter::to_string(cloud.error()));
      return false;
    }
    const kilter::Pose3 T = log.T_world_cloud[first].inverse() * log.T_world_cloud[i];
    Scan& scan = scans.emplace_back();
    scan.origin_m = T.translation_m().cast<float>().cast<double>();
    for (const Eigen::Vector3f& point : cloud->points_m) {
      const Eigen::Vector3f at_m = (T * point.cast<double>()).cast<float>();
      if (point.norm() < 0.5F) continue;
      scan.points_m.push_back(at_m.cast<double>());
      scan.cloud.push_back(at_m.x(), at_m.y(), at_m.z());
    }
  }
  return true;
}

struct Agreement {
  std::size_t both = 0;
  std::size_t either = 0;
  std::size_t other_free = 0;  // free in one map only
  double log_odds = 0.0;       // largest difference

  [[nodiscard]] double iou() const { return static_cast<double>(both) / static_cast<double>(either); }
};

Agreement compare(const kilter::VoxelMap& map, const octomap::OcTree& tree) {
  Agreement out;
  std::size_t theirs_free = 0;
  std::size_t both_free = 0;
  std::size_t theirs = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    const kilter::VoxelIndex at(key[0] - 32768, key[1] - 32768, key[2] - 32768);
    const kilter::CellState state = map.state(at);
    if (!tree.isNodeOccupied(*leaf)) {
      ++theirs_free;
      both_free += state == kilter::CellState::kFree ? 1 : 0;
      continue;
    }
    ++theirs;
    if (state != kilter::CellState::kOccupied) continue;
    ++out.both;
    const float ours = map.voxels().log_odds[static_cast<std::size_t>(map.find_voxel(at))];
    out.log_odds = std::max(out.log_odds, static_cast<double>(std::abs(ours - leaf->getLogOdds())));
  }
  std::size_t ours_free = 0;
  for (const kilter::VoxelBlock& block : map.blocks()) {
    for (const std::uint64_t layer : block.free) ours_free += static_cast<std::size_t>(std::popcount(layer));
  }
  out.either = theirs + map.voxels().size() - out.both;
  out.other_free = theirs_free + ours_free - 2 * both_free;
  return out;
}

double cells_passed(const std::vector<Scan>& scans) {
  const octomap::OcTree tree(kResolution_m);
  octomap::KeyRay ray;
  double cells = 0.0;
  for (const Scan& scan : scans) {
    const octomap::point3d origin = origin_of(scan);
    for (const octomap::point3d& point : scan.cloud) {
      octomap::point3d end = point;
      if ((point - origin).norm() > kMaxRange_m) {
        end = origin + (point - origin).normalized() * static_cast<float>(kMaxRange_m);
      }
      if (tree.computeRayKeys(origin, end, ray)) cells += static_cast<double>(ray.size());
    }
  }
  return cells;
}

std::string name_of(VectorPath path) {
  if (path == VectorPath::kAvx512) return "kilter, AVX-512";
  if (path == VectorPath::kNeon) return "kilter, NEON";
  return path == VectorPath::kAvx2 ? "kilter, AVX2" : "kilter, ray by ray";
}

void insert_all(const std::vector<Scan>& scans, kilter::MapBuilder& builder) {
  for (const Scan& scan : scans) builder.insert_scan(scan.points_m, scan.origin_m);
}

void insert_all(const std::vector<Scan>& scans, octomap::OcTree& tree) {
  for (const Scan& scan : scans) tree.insertPointCloud(scan.cloud, origin_of(scan), kMaxRange_m, true);
}

struct Method {
  std::string name;
  std::function<void()> run;
  std::vector<double> times_s = {};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    fmt::print(stderr, "usage: kilter_integration_benchmark NAME ROBOT_FOLDER SCANS ROUNDS JSON_FILE\n");
    return 2;
  }
  const std::string world = argv[1];
  std::vector<Scan> scans;
  if (!read_scans(argv[2], 0, std::stoul(argv[3]), scans)) return 2;
  const int rounds = std::stoi(argv[4]);

  // First whether it is the same map; with it, what each holds in memory, and what finish() adds.
  const double before_mb = megabytes_in_use();
  kilter::MapBuilder builder(options());
  insert_all(scans, builder);
  const double ours_mb = megabytes_in_use() - before_mb;
  kilter::VoxelMap map;
  const double finish_s = seconds([&] { map = builder.finish(); });
  octomap::OcTree tree(kResolution_m);
  insert_all(scans, tree);
  const double theirs_mb = static_cast<double>(tree.memoryUsage()) / 1e6;
  const Agreement agreement = compare(map, tree);
  if (agreement.both != agreement.either || agreement.other_free != 0 || agreement.log_odds != 0.0) {
    fmt::print(stderr, "{}: not OctoMap's map: IoU {}, {} free voxels, log-odds {}\n", world, agreement.iou(),
               agreement.other_free, agreement.log_odds);
    return 1;
  }
  tree.clear();

  std::vector<Method> methods;
  for (auto path = kilter::vector_paths().rbegin(); path != kilter::vector_paths().rend(); ++path) {
    methods.push_back({name_of(*path), [&scans, path = *path] {
                         kilter::MapBuilder another(options(), path);
                         insert_all(scans, another);
                       }});
  }
  methods.push_back({"OctoMap, lazy", [&scans] {
                       octomap::OcTree another(kResolution_m);
                       insert_all(scans, another);
                     }});
  for (int round = 0; round < rounds; ++round) {
    for (Method& method : methods) method.times_s.push_back(seconds(method.run));
  }
  const auto count = static_cast<double>(scans.size());
  double points = 0.0;
  for (const Scan& scan : scans) points += static_cast<double>(scan.points_m.size());
  const double cells = cells_passed(scans);
  const double slowest_s = median(methods.back().times_s);
  std::string json = fmt::format(
      R"({{"world": "{}", "scans": {}, "points": {}, "cells": {}, "voxels": {}, "iou": {}, "finish_s": {}, )"
      R"("kilter_mb": {}, "octomap_mb": {}, "rounds": {}, "scans_per_s": {{)",
      world, count, points, cells, map.voxels().size(), agreement.iou(), finish_s, ours_mb, theirs_mb, rounds);
  for (const Method& method : methods) {
    const double own_s = median(method.times_s);
    fmt::print("| {}, {} | {:.0f} | {:.0f} | {} | {:.1f} | {:.2f} | {:.1f}x | {} | {:.0f} |\n", world, method.name,
               points / count, cells / points, map.voxels().size(), count / own_s, own_s / cells * 1e9,
               slowest_s / own_s, agreement.iou(), &method == &methods.back() ? theirs_mb : ours_mb);
    json += fmt::format(R"({}"{}": {})", &method == &methods.front() ? "" : ", ", method.name, count / own_s);
  }
  fmt::print("| {}, finish() of the first: centroids, normals | | | | | {:.0f} ns a voxel | | | |\n", world,
             finish_s / static_cast<double>(map.voxels().size()) * 1e9);
  std::FILE* const file = std::fopen(argv[5], "a");
  if (file == nullptr) return 2;
  fmt::print(file, "{}}}}}\n", json);
  std::fclose(file);
  return 0;
}
