// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How fast kilter reads an .ot, a binary and a binary_compressed .pcd, beside liboctomap, PCL and Open3D where they
// were found. What every reader found is compared with what was written before its time is printed.
#include <fmt/format.h>
#include <liblzf/lzf.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
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
#ifdef KILTER_HAS_OPEN3D
#include <open3d/geometry/PointCloud.h>
#include <open3d/io/PointCloudIO.h>
#endif

namespace {

constexpr int kRounds = 5;
constexpr std::size_t kPoints = 10'000'000;

// What a file holds, whatever the order: how many, and a sum of a hash of each.
struct Digest {
  std::size_t count = 0;
  std::uint64_t sum = 0;

  template <typename... Words>
  void add(Words... words) {
    std::uint64_t hash = 0xCBF29CE484222325;
    ((hash = std::rotl((hash ^ static_cast<std::uint64_t>(words)) * 0x9E3779B97F4A7C15, 29)), ...);
    sum += hash;
    ++count;
  }
  void add_point(float x, float y, float z) {
    add(std::bit_cast<std::uint32_t>(x), std::bit_cast<std::uint32_t>(y), std::bit_cast<std::uint32_t>(z));
  }
  bool operator==(const Digest&) const = default;
};

// A reader under test. Only reading counts; what it returns tells what was read, and keeps that until it was told.
struct Reader {
  std::string name;
  std::function<std::function<Digest()>()> read;
};

double median_of(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + kRounds / 2, values.end());
  return values[kRounds / 2];
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Times {
  std::vector<double> wall_s;
  std::vector<double> processor_s;
};

// All readers in turn, several times over, so that a busy machine is unfair to none. They all run in one thread, so
// that processor time is what each would take on an idle machine. Each reads once before its time counts: what it
// costs to touch memory depends on who used it last, most of all on machines that hand free memory back to a host.
// \return false if one is wrong.
bool compare(const std::string& what, const Digest& written, const std::vector<Reader>& readers) {
  std::vector<Times> times(readers.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < readers.size(); ++i) {
      readers[i].read();
      const double processor_start_s = processor_seconds();
      const auto start = std::chrono::steady_clock::now();
      const std::function<Digest()> found = readers[i].read();
      times[i].wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      times[i].processor_s.push_back(processor_seconds() - processor_start_s);
      const Digest digest = found();
      if (digest == written) continue;
      fmt::print("{}: {} finds {} that are not the {} written\n", what, readers[i].name, digest.count, written.count);
      return false;
    }
  }
  fmt::print("{}\n", what);
  const double ours_s = median_of(times[0].processor_s);
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const double median_s = median_of(times[i].processor_s);
    fmt::print("  {:<11} {:7.3f} s of processor, {:7.3f} s in all, {:6.1f} M/s; kilter is {:.1f} times as fast\n",
               readers[i].name, median_s, median_of(times[i].wall_s),
               static_cast<double>(written.count) / median_s / 1e6, median_s / ours_s);
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

Digest digest_of(const kilter::OccupancyCells& known) {
  Digest digest;
  for (const kilter::OccupancyCell& cell : known.cells) {
    digest.add(cell.index[0], cell.index[1], cell.index[2], cell.level, std::bit_cast<std::uint32_t>(cell.log_odds));
  }
  return digest;
}

bool compare_octrees(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "floor.ot";
  const kilter::OccupancyCells known = floor_cells();
  if (!write(path, kilter::octree_bytes(known, kilter::OctreeFormat::kFull))) return false;
  std::vector<Reader> readers;
  readers.push_back({"kilter", [&] {
                       const auto cells =
                           std::make_shared<kilter::Expected<kilter::OccupancyCells>>(kilter::read_octree_file(path));
                       return [cells] { return *cells ? digest_of(**cells) : Digest(); };
                     }});
#ifdef KILTER_HAS_OCTOMAP
  readers.push_back({"liboctomap", [&] {
                       const std::shared_ptr<octomap::AbstractOcTree> tree(
                           octomap::AbstractOcTree::read(path.string()));
                       return [tree] {
                         Digest digest;
                         const auto* octree = dynamic_cast<const octomap::OcTree*>(tree.get());
                         if (octree == nullptr) return digest;
                         for (auto leaf = octree->begin_leafs(); leaf != octree->end_leafs(); ++leaf) {
                           const octomap::OcTreeKey key = leaf.getIndexKey();
                           digest.add(key[0] - 32768, key[1] - 32768, key[2] - 32768, 16 - leaf.getDepth(),
                                      std::bit_cast<std::uint32_t>(leaf->getLogOdds()));
                         }
                         return digest;
                       };
                     }});
#endif
  return compare(fmt::format(".ot, {} leaves, {:.0f} MB", known.cells.size(),
                             static_cast<double>(std::filesystem::file_size(path)) / 1e6),
                 digest_of(known), readers);
}

// Lines of a scanner that sweeps over rough ground, to the millimetre, so that there is something to compress.
std::vector<Eigen::Vector3f> swept_ground() {
  constexpr std::size_t kLine = 2000;
  kilter::Rng rng(2, 0);
  std::vector<Eigen::Vector3f> points_m(kPoints);
  const auto to_millimetres = [](double metres) { return static_cast<float>(std::round(1000.0 * metres) / 1000.0); };
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double along_m = 0.05 * static_cast<double>(i % kLine);
    const double across_m = 0.02 * static_cast<double>(i / kLine);
    points_m[i] = {to_millimetres(along_m), to_millimetres(across_m), to_millimetres(rng.uniform(-0.02, 0.02))};
  }
  return points_m;
}

// The same points as binary_compressed: axis after axis, packed by LZF, both sizes before it.
std::string packed_pcd(const std::string& binary) {
  const std::string data_line = "DATA binary\n";
  const std::size_t begin = binary.find(data_line) + data_line.size();
  std::string by_axis(binary.size() - begin, '\0');
  for (std::size_t i = 0; i < kPoints; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::memcpy(&by_axis[4 * (axis * kPoints + i)], &binary[begin + 12 * i + 4 * axis], 4);
    }
  }
  std::string packed(by_axis.size(), '\0');
  const std::uint32_t packed_bytes = lzf_compress(by_axis.data(), static_cast<unsigned>(by_axis.size()), packed.data(),
                                                  static_cast<unsigned>(packed.size()));
  const auto bytes = static_cast<std::uint32_t>(by_axis.size());
  std::string sizes(8, '\0');
  std::memcpy(sizes.data(), &packed_bytes, 4);
  std::memcpy(&sizes[4], &bytes, 4);
  return binary.substr(0, begin - data_line.size()) + "DATA binary_compressed\n" + sizes +
         packed.substr(0, packed_bytes);
}

std::vector<Reader> cloud_readers(const std::string& path) {
  std::vector<Reader> readers;
  readers.push_back({"kilter", [path] {
                       const auto cloud =
                           std::make_shared<kilter::Expected<kilter::PointCloud>>(kilter::read_cloud_file(path));
                       return [cloud] {
                         Digest digest;
                         if (!*cloud) return digest;
                         for (const Eigen::Vector3f& p : (*cloud)->points_m) digest.add_point(p.x(), p.y(), p.z());
                         return digest;
                       };
                     }});
#ifdef KILTER_HAS_PCL
  readers.push_back({"PCL", [path] {
                       const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
                       pcl::io::loadPCDFile(path, *cloud);
                       return [cloud] {
                         Digest digest;
                         for (const pcl::PointXYZ& p : *cloud) digest.add_point(p.x, p.y, p.z);
                         return digest;
                       };
                     }});
#endif
#ifdef KILTER_HAS_OPEN3D
  readers.push_back({"Open3D", [path] {
                       const auto cloud = std::make_shared<open3d::geometry::PointCloud>();
                       open3d::io::ReadPointCloud(path, *cloud);
                       return [cloud] {
                         Digest digest;
                         for (const Eigen::Vector3d& p : cloud->points_) {
                           const Eigen::Vector3f point_m = p.cast<float>();
                           digest.add_point(point_m.x(), point_m.y(), point_m.z());
                         }
                         return digest;
                       };
                     }});
#endif
  return readers;
}

bool compare_clouds(const std::filesystem::path& folder) {
  const std::vector<Eigen::Vector3f> points_m = swept_ground();
  Digest written;
  for (const Eigen::Vector3f& p : points_m) written.add_point(p.x(), p.y(), p.z());
  const std::string binary = kilter::cloud_pcd(points_m);
  const std::filesystem::path plain = folder / "cloud.pcd";
  const std::filesystem::path packed = folder / "packed.pcd";
  if (!write(plain, binary) || !write(packed, packed_pcd(binary))) return false;
  return compare(fmt::format(".pcd, binary, {} points", kPoints), written, cloud_readers(plain.string())) &&
         compare(fmt::format(".pcd, binary_compressed, {} points, {:.0f} MB", kPoints,
                             static_cast<double>(std::filesystem::file_size(packed)) / 1e6),
                 written, cloud_readers(packed.string()));
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
