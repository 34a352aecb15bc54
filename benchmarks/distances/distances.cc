// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How fast the closest voxels of a pair are found, beside other libraries on the same points, and how near that is to
// what the machine can do. All answers are held against brute force on a sample before their times count.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "../processor_clock.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/pose_reader.h"
#include "kilter/matching/nearest_voxel_field.h"
#include "kilter/occupancy/map_builder.h"
#include "methods.h"
#include "probes.h"

namespace kilter {
namespace {

constexpr int kRounds = 5;
constexpr int kPoses = 30;
constexpr std::size_t kSample = 500;
constexpr double kMostEdtCells = 2e7;  // half a gigabyte
constexpr std::size_t kLineBytes = 64;
constexpr std::size_t kExactMethods = 2;
constexpr double kExact_m = 1e-5;

double seconds(const std::function<void()>& work) {
  const double start_s = processor_seconds();
  work();
  return processor_seconds() - start_s;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Differences from brute force over a sample; what is beyond the limit counts as the limit. [m]
struct Errors {
  double largest_m = 0.0;
  double mean_m = 0.0;
};

Errors errors_of(const Side& source, const Side& target, const Pose3& pose, const std::vector<float>& distances_m) {
  Errors errors;
  const std::size_t stride = std::max<std::size_t>(1, source.points_m.size() / kSample);
  std::size_t count = 0;
  for (std::size_t i = 0; i < source.points_m.size(); i += stride, ++count) {
    const Eigen::Vector3d at_m = moved(pose.isometry(), source.points_m[i]);
    double least_m = kLimit_m;
    for (const Eigen::Vector3f& point_m : target.points_m) {
      least_m = std::min(least_m, (point_m.cast<double>() - at_m).norm());
    }
    const double said_m = distances_m[i] == kNone ? kLimit_m : static_cast<double>(distances_m[i]);
    errors.largest_m = std::max(errors.largest_m, std::abs(least_m - said_m));
    errors.mean_m += std::abs(least_m - said_m);
  }
  errors.mean_m /= static_cast<double>(count);
  return errors;
}

bool read_side(const std::string& file, Side& side) {
  const auto cloud = read_cloud_file(file);
  if (!cloud) {
    fmt::print(stderr, "{}\n", to_string(cloud.error()));
    return false;
  }
  std::vector<Eigen::Vector3d> points_m;
  for (const Eigen::Vector3f& point_m : cloud->points_m) points_m.push_back(point_m.cast<double>());
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points_m);
  side.map = builder.finish();
  side.points_m = side.map.voxels().centroids_m;
  return true;
}

// The map's pose, and around it what a registration's steps and restarts go through.
std::vector<Pose3> poses_around(const Pose3& T_target_source) {
  std::vector<Pose3> poses;
  for (int i = 0; i < kPoses; ++i) {
    const double share = 1.0 - static_cast<double>(i) / (kPoses - 1);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.05 * share * share, Eigen::Vector3d::UnitZ()));
    poses.push_back(T_target_source * Pose3(turn, Eigen::Vector3d(0.4, -0.2, 0.05) * share * share));
  }
  return poses;
}

std::vector<Method> methods_for(const Side& source, const Side& target) {
  // The first kExactMethods, then the field.
  std::vector<Method> methods = {all_together(source, target), one_by_one(source, target), by_field(source, target)};
#ifdef KILTER_HAS_NANOFLANN
  methods.push_back(by_nanoflann(source, target));
#endif
#ifdef KILTER_HAS_PCL_KDTREE
  methods.push_back(by_pcl(source, target));
#endif
#ifdef KILTER_HAS_OPEN3D
  methods.push_back(by_open3d(source, target));
#endif
#ifdef KILTER_HAS_DYNAMIC_EDT
  const Eigen::Vector3d box_m = target.map.bounds_m().sizes() + Eigen::Vector3d::Constant(2.0 * kLimit_m);
  if ((box_m / target.map.resolution_m()).prod() < kMostEdtCells) methods.push_back(by_dynamic_edt(source, target));
#endif
  return methods;
}

// What the processor cannot do without in a look-up of every point: the lines of the field that they touch, in no order
// that it could foresee, and the points themselves.
std::string floor_row(const std::string& name, const Side& source, const Side& target, const Pose3& pose,
                      double warm_ns) {
  const NearestVoxelField field(target.map, kLimit_m);
  const Eigen::Isometry3d T = pose.isometry();
  std::unordered_set<std::size_t> lines;
  for (const Eigen::Vector3f& point_m : source.points_m) {
    lines.insert(reinterpret_cast<std::uintptr_t>(field.where(moved(T, point_m))) / kLineBytes);
  }
  const auto points = static_cast<double>(source.points_m.size());
  const double per_point = static_cast<double>(lines.size()) / points;
  const double line_ns = random_line_ns(field.bytes());
  const double byte_ns = sequential_byte_ns(source.points_m.size() * sizeof(Eigen::Vector3f));
  const double floor_ns = per_point * line_ns + sizeof(Eigen::Vector3f) * byte_ns;
  return fmt::format("| {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} |\n", name,
                     static_cast<double>(field.bytes()) / 1e6, cycles_per_ns(), per_point, line_ns, byte_ns, floor_ns,
                     warm_ns, warm_ns / floor_ns);
}

struct Times {
  std::vector<double> cold;
  std::vector<double> often;
  std::vector<double> warm;
};

// \return the row of the second table, or nothing where an answer of kilter's is wrong.
std::optional<std::string> compare(const std::string& name, const Side& source, const Side& target,
                                   const Pose3& T_target_source) {
  const std::vector<Method> methods = methods_for(source, target);
  const std::vector<Pose3> one = {T_target_source};
  const std::vector<Pose3> many = poses_around(T_target_source);
  std::vector<Times> times(methods.size());
  std::vector<Errors> errors(methods.size());
  std::vector<float> distances_m(source.points_m.size());
  std::size_t within = 0;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      times[m].often.push_back(seconds([&] { methods[m].run(many, distances_m, true); }));
      times[m].cold.push_back(seconds([&] { methods[m].run(one, distances_m, true); }));
      times[m].warm.push_back(seconds([&] { methods[m].run(one, distances_m, false); }));
      if (round > 0) continue;
      errors[m] = errors_of(source, target, T_target_source, distances_m);
      if (m < kExactMethods && errors[m].largest_m > kExact_m) {
        fmt::print(stderr, "{}, {}: off by {} m\n", name, methods[m].name, errors[m].largest_m);
        return std::nullopt;
      }
      if (m > 0) continue;
      within = static_cast<std::size_t>(
          std::count_if(distances_m.begin(), distances_m.end(), [](float d) { return d != kNone; }));
    }
  }
  const auto points = static_cast<double>(source.points_m.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const auto cell = [&](std::vector<double> Times::*which, double queries) {
      const double own_s = median(times[m].*which);
      const std::string text = fmt::format("{:.0f} ns", own_s / queries * 1e9);
      return m == 0 ? text : fmt::format("{} ({:.1f}x)", text, own_s / median(times[0].*which));
    };
    fmt::print("| {}, {} | {} to {} | {:.0f} % | {} | {} | {} | {:.1e} m | {:.1e} m |\n", name, methods[m].name,
               source.points_m.size(), target.points_m.size(), 100.0 * static_cast<double>(within) / points,
               cell(&Times::cold, points), cell(&Times::often, kPoses * points), cell(&Times::warm, points),
               errors[m].largest_m, errors[m].mean_m);
  }
  return floor_row(name, source, target, T_target_source, median(times[kExactMethods].warm) / points * 1e9);
}

// Prints the mean distance [m], the limit where nothing is within it, of how many points, and how long the search took,
// building included [s].
void print_mean(const Side& source, const Side& target, const Pose3& T_target_source) {
  std::vector<float> distances_m(source.points_m.size());
  const Method method = all_together(source, target);
  const double search_s = seconds([&] { method.run(std::vector<Pose3>{T_target_source}, distances_m, true); });
  double sum_m = 0.0;
  for (const float distance_m : distances_m) sum_m += distance_m == kNone ? kLimit_m : double{distance_m};
  fmt::print("{:.9f} {} {:.6f}\n", sum_m / static_cast<double>(distances_m.size()), distances_m.size(), search_s);
}

int run(const std::vector<std::string>& words) {
  const bool mean_only = words.size() == 5 && words[1] == "--mean";
  if (words.size() != 6 && !mean_only) {
    fmt::print(stderr,
               "usage: kilter_distances_benchmark NAME TARGET.pcd SOURCE.pcd POSES.tum FLOOR_ROWS\n"
               "       kilter_distances_benchmark --mean TARGET SOURCE POSES.tum\n");
    return 2;
  }
  Side target;
  Side source;
  const auto poses = read_file(words[4]);
  if (!poses || !read_side(words[2], target) || !read_side(words[3], source)) return 2;
  const auto T_world_submap = read_poses(poses->view(), words[4]);
  if (!T_world_submap || T_world_submap->size() < 2) return 2;
  const Pose3 T_target_source = (*T_world_submap)[0].inverse() * (*T_world_submap)[1];
  if (mean_only) {
    print_mean(source, target, T_target_source);
    return 0;
  }
  const auto row = compare(words[1], source, target, T_target_source);
  if (!row) return 1;
  std::ofstream rows(words[5], std::ios::app);
  rows << *row;
  return rows.flush() ? 0 : 2;
}

}  // namespace
}  // namespace kilter

int main(int argc, char** argv) { return kilter::run({argv, argv + argc}); }
