// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// kilter_kernels KERNEL PATH   runs one kernel once, on the same small scene always, and prints what it found
// kilter_kernels --list        names of the kernels, and of the paths that this processor has
// kilter_kernels --compiler    what built it
//
// Only what happens inside kilter_counted is the kernel; a tool that counts instructions is told that name.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/vector_path.h"
#include "kilter/matching/nearest_of_all.h"
#include "kilter/matching/nearest_voxel.h"
#include "kilter/occupancy/map_builder.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/plane_matches.h"
#include "testing/scenes.h"

extern "C" __attribute__((noinline)) void kilter_counted(const std::function<void()>& work) { work(); }

namespace {

using kilter::NearestVoxelSearch;
using kilter::Pose3;
using kilter::VectorPath;
using kilter::VoxelPosition;

constexpr double kReach_m = 1.0;

struct Scene {
  explicit Scene(VectorPath path)
      : source(pair.source.map, VoxelPosition::kCentroid, kReach_m, path),
        target(pair.target.map, VoxelPosition::kCentroid, kReach_m, path) {}

  kilter::testing::SubmapPair pair = kilter::testing::room_pair();
  NearestVoxelSearch source;
  NearestVoxelSearch target;

  // Every source voxel, a little off its place.
  [[nodiscard]] std::vector<Eigen::Vector3d> points_target_m() const {
    const Pose3 T = Pose3::from_translation(0.05, -0.03, 0.02) * pair.T_target_source;
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3f& centroid : pair.source.map.voxels().centroids_m)
      points.push_back(T * centroid.cast<double>());
    return points;
  }
};

std::string distances(std::size_t asked, const std::function<void(std::vector<kilter::NearestVoxel>&)>& search) {
  std::vector<kilter::NearestVoxel> found(asked);
  kilter_counted([&] { search(found); });
  std::erase_if(found, [](const kilter::NearestVoxel& each) { return each.voxel == kilter::kNoVoxel; });
  double sum_m = 0.0;
  for (const kilter::NearestVoxel& each : found) sum_m += each.distance_m;
  return fmt::format("{} of {} points, {:.6f} m together", found.size(), asked, sum_m);
}

// What exact searches search with, of both submaps.
std::string exact_search_built(VectorPath path) {
  const kilter::testing::SubmapPair pair = kilter::testing::room_pair();
  std::size_t clusters = 0;
  kilter_counted([&] {
    for (const kilter::Submap* const submap : {&pair.source, &pair.target}) {
      clusters += NearestVoxelSearch(submap->map, VoxelPosition::kCentroid, kReach_m, path).clusters().boxes().size();
    }
  });
  return fmt::format("{} clusters", clusters);
}

// One pose, the statistic's search.
std::string exact_search_of_all(VectorPath path) {
  const Scene scene(path);
  const Pose3 T = Pose3::from_translation(0.05, -0.03, 0.02) * scene.pair.T_target_source;
  return distances(scene.source.map().voxels().size(), [&](std::vector<kilter::NearestVoxel>& found) {
    found = kilter::nearest_of_all(scene.source, scene.target, T, kReach_m, path);
  });
}

// The same points one by one, as where only some are asked for.
std::string exact_search(VectorPath path) {
  const Scene scene(path);
  const std::vector<Eigen::Vector3d> points_m = scene.points_target_m();
  kilter::NearestVoxelCursor cursor(scene.target);
  return distances(points_m.size(), [&](std::vector<kilter::NearestVoxel>& found) {
    std::transform(points_m.begin(), points_m.end(), found.begin(), [&](const Eigen::Vector3d& at_m) {
      return cursor.nearest(at_m, kReach_m).value_or(kilter::NearestVoxel{kilter::kNoVoxel, 0.0});
    });
  });
}

// Registration's search, once the field is there.
std::string field_look_up(VectorPath path) {
  const Scene scene(path);
  const std::vector<Eigen::Vector3d> points_m = scene.points_target_m();
  std::vector<std::uint32_t> numbers(points_m.size());
  std::iota(numbers.begin(), numbers.end(), 0U);
  kilter::RepeatedSearch search(scene.target, points_m.size());
  std::vector<kilter::PointColumns> columns(points_m.size() / kilter::PointColumns::kMost + 1);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    columns[i / kilter::PointColumns::kMost].set(i % kilter::PointColumns::kMost, points_m[i]);
  }
  const auto look_up = [&](std::vector<kilter::NearestVoxel>& found) {
    kilter::RepeatedSearch::Found near;
    for (std::size_t first = 0; first < numbers.size(); first += kilter::PointColumns::kMost) {
      const auto batch =
          std::span(numbers).subspan(first, std::min(kilter::PointColumns::kMost, numbers.size() - first));
      search.near(batch, columns[first / kilter::PointColumns::kMost], kReach_m, near);
      for (std::size_t k = 0; k < batch.size(); ++k) found[first + k] = {near.voxel[k], std::sqrt(near.square_m2[k])};
    }
  };
  std::vector<kilter::NearestVoxel> first(points_m.size());
  look_up(first);
  return distances(points_m.size(), look_up);
}

std::string ray_integration(VectorPath path) {
  const std::vector<Eigen::Vector3d> points_m =
      kilter::testing::scan(kilter::testing::furnished_room(), kilter::testing::pose_at(3.0, 3.0, 1.2, 0.3), 0.01, 1);
  kilter::MapBuilder builder({.resolution_m = 0.1}, path);
  kilter_counted([&] {
    for (int k = 0; k < 3; ++k) builder.insert_scan(points_m, Eigen::Vector3d::Zero());
  });
  return fmt::format("{} occupied voxels of {} points", builder.finish().voxels().size(), points_m.size());
}

std::string plane_matches(VectorPath path) {
  const Scene scene(path);
  kilter::PlanePair pair{scene.source, scene.target};
  (void)kilter::match_planes(pair, scene.pair.T_target_source, kReach_m, kilter::kAllPoints);
  std::vector<kilter::PlaneResidual> residuals;
  kilter_counted([&] {
    residuals = kilter::match_planes(pair, Pose3::from_translation(0.05, -0.03, 0.02) * scene.pair.T_target_source,
                                     kReach_m, kilter::kAllPoints);
  });
  return fmt::format("{} matches", residuals.size());
}

std::string normal_equations(VectorPath path) {
  const Scene scene(path);
  kilter::PlanePair pair{scene.source, scene.target};
  const auto residuals = kilter::match_planes(pair, scene.pair.T_target_source, kReach_m, kilter::kAllPoints);
  kilter::NormalEquations equations;
  kilter_counted([&] { equations = kilter::build_normal_equations(residuals); });
  return fmt::format("{} residuals, weight {:.6f}", residuals.size(), equations.weight);
}

struct Kernel {
  std::string_view name;
  std::string (*run)(VectorPath path);
};
constexpr std::array kKernels = {
    Kernel{"exact-search-built", exact_search_built},   Kernel{"exact-search", exact_search},
    Kernel{"exact-search-of-all", exact_search_of_all}, Kernel{"field-look-up", field_look_up},
    Kernel{"ray-integration", ray_integration},         Kernel{"plane-matches", plane_matches},
    Kernel{"normal-equations", normal_equations}};

struct Path {
  std::string_view name;
  VectorPath path;
};
constexpr std::array kPaths = {Path{"baseline", VectorPath::kBaseline}, Path{"avx2", VectorPath::kAvx2},
                               Path{"avx512", VectorPath::kAvx512}, Path{"neon", VectorPath::kNeon}};

bool has(VectorPath path) {
  const std::span<const VectorPath> all = kilter::vector_paths();
  return std::find(all.begin(), all.end(), path) != all.end();
}

void list() {
  for (const Kernel& kernel : kKernels) fmt::print("kernel {}\n", kernel.name);
  for (const Path& path : kPaths) {
    if (has(path.path)) fmt::print("path {}\n", path.name);
  }
}

int run(std::string_view kernel_name, std::string_view path_name) {
  for (const Path& path : kPaths) {
    if (path.name != path_name || !has(path.path)) continue;
    for (const Kernel& kernel : kKernels) {
      if (kernel.name != kernel_name) continue;
      fmt::print("{}\n", kernel.run(path.path));
      return 0;
    }
  }
  fmt::print(stderr, "no kernel {} or no path {} here\n", kernel_name, path_name);
  return 2;
}

}  // namespace

int main(int count, char** words) {
  const std::vector<std::string_view> arguments(words + 1, words + count);
  if (arguments.size() == 1 && arguments[0] == "--list") {
    list();
    return 0;
  }
  if (arguments.size() == 1 && arguments[0] == "--compiler") {
#if defined(__clang__)
    fmt::print("clang-{}.{}\n", __clang_major__, __clang_minor__);
#else
    fmt::print("gcc-{}.{}\n", __GNUC__, __GNUC_MINOR__);
#endif
    return 0;
  }
  if (arguments.size() == 2) return run(arguments[0], arguments[1]);
  fmt::print(stderr, "kilter_kernels KERNEL PATH | --list | --compiler\n");
  return 2;
}
