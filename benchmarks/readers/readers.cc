// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How fast kilter reads an .ot and a binary .pcd, beside liboctomap and PCL where they were found. Every reader's
// answer is held against what was written before its time counts.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/octree_writer.h"
#include "kilter/report/cloud_pcd.h"

#ifdef KILTER_HAS_OCTOMAP
#include <octomap/OcTree.h>
#endif
#ifdef KILTER_HAS_PCL
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>
#endif

namespace {

constexpr int kRounds = 5;
constexpr std::size_t kPoints = 10'000'000;

// A reader under test: how many leaves or points it finds.
struct Reader {
  std::string name;
  std::function<std::size_t()> read;
};

// All readers in turn, several times over, so that a busy machine is unfair to none. \return false if one is wrong.
bool compare(const std::string& what, std::size_t expected, const std::vector<Reader>& readers) {
  std::vector<double> best_s(readers.size(), INFINITY);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < readers.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      const std::size_t found = readers[i].read();
      best_s[i] = std::min(best_s[i], std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      if (found == expected) continue;
      fmt::print("{}: {} finds {} instead of {}\n", what, readers[i].name, found, expected);
      return false;
    }
  }
  fmt::print("{}\n", what);
  for (std::size_t i = 0; i < readers.size(); ++i) {
    fmt::print("  {:<11} {:8.3f} s  {:6.1f} M/s  kilter is {:.1f} times as fast\n", readers[i].name, best_s[i],
               static_cast<double>(expected) / best_s[i] / 1e6, best_s[i] / best_s[0]);
  }
  return true;
}

bool write(const std::filesystem::path& path, const std::string& bytes) {
  const auto done = kilter::write_file_atomically(path, bytes);
  if (!done) fmt::print("{}\n", kilter::to_string(done.error()));
  return done.has_value();
}

// Free space around a floor of 160 m by 160 m at 0.1 m, with values that do not prune.
kilter::OccupancyCells floor_cells() {
  kilter::Rng rng(1, 0);
  kilter::OccupancyCells known{0.1, {}};
  for (int x = -800; x < 800; ++x) {
    for (int y = -800; y < 800; ++y) {
      const double height = 8.0 * std::sin(0.02 * x) + 6.0 * std::cos(0.03 * y);
      for (int z = 0; z < 3; ++z) {
        const auto at = [](double value) { return static_cast<std::int16_t>(std::floor(value)); };
        const double log_odds = (z == 0 ? 1.0 : -1.0) + rng.uniform(-0.5, 0.5);
        known.cells.push_back({{at(x), at(y), at(height + z)}, 0, static_cast<float>(log_odds)});
      }
    }
  }
  return known;
}

bool compare_octrees(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "floor.ot";
  const kilter::OccupancyCells known = floor_cells();
  if (!write(path, kilter::octree_bytes(known, kilter::OctreeFormat::kFull))) return false;
  std::vector<Reader> readers = {{"kilter", [&] {
                                    const auto cells = kilter::read_octree_file(path);
                                    return cells ? cells->cells.size() : 0;
                                  }}};
#ifdef KILTER_HAS_OCTOMAP
  readers.push_back({"liboctomap", [&] {
                       const std::unique_ptr<octomap::AbstractOcTree> tree(
                           octomap::AbstractOcTree::read(path.string()));
                       const auto* octree = dynamic_cast<octomap::OcTree*>(tree.get());
                       return octree == nullptr ? 0 : octree->getNumLeafNodes();
                     }});
#endif
  return compare(fmt::format(".ot, {} leaves, {:.0f} MB", known.cells.size(),
                             static_cast<double>(std::filesystem::file_size(path)) / 1e6),
                 known.cells.size(), readers);
}

bool compare_clouds(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "cloud.pcd";
  kilter::Rng rng(2, 0);
  std::vector<Eigen::Vector3f> points_m(kPoints);
  for (Eigen::Vector3f& point_m : points_m) {
    for (int axis = 0; axis < 3; ++axis) point_m[axis] = static_cast<float>(rng.uniform(-100.0, 100.0));
  }
  if (!write(path, kilter::cloud_pcd(points_m))) return false;
  std::vector<Reader> readers = {{"kilter", [&] {
                                    const auto cloud = kilter::read_cloud_file(path);
                                    return cloud ? cloud->points_m.size() : 0;
                                  }}};
#ifdef KILTER_HAS_PCL
  readers.push_back({"PCL", [&] {
                       pcl::PointCloud<pcl::PointXYZ> cloud;
                       return pcl::io::loadPCDFile(path.string(), cloud) == 0 ? cloud.size() : 0;
                     }});
#endif
  return compare(fmt::format(".pcd, binary, {} points", kPoints), kPoints, readers);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: kilter_readers_benchmark FOLDER\n");
    return 2;
  }
  const bool octrees = compare_octrees(argv[1]);
  return compare_clouds(argv[1]) && octrees ? 0 : 1;
}
