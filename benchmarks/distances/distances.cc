// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How fast the closest voxels of a pair are found, beside a kd-tree on the same points. Both answers are held against
// brute force on a sample before their times count.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/pose_reader.h"
#include "kilter/matching/nearest_of_all.h"
#include "kilter/matching/nearest_voxel.h"
#include "kilter/occupancy/map_builder.h"

#ifdef KILTER_HAS_NANOFLANN
#include <nanoflann.hpp>
#endif

namespace {

using kilter::NearestVoxelCursor;
using kilter::NearestVoxelSearch;
using kilter::Pose3;

constexpr int kRounds = 5;
constexpr int kPoses = 30;
constexpr double kLimit_m = 1.0;
constexpr float kNone = -1.0F;

// A submap's map and the points that stand for its voxels.
struct Side {
  kilter::VoxelMap map;
  std::vector<Eigen::Vector3f> points_m;
};

// One way to find distances: everything it needs is built anew, then the distances under each pose are written.
struct Method {
  std::string name;
  std::function<void(const std::vector<Pose3>& poses, std::vector<float>& distances_m, bool build)> run;
};

Eigen::Vector3d moved(const Eigen::Isometry3d& T, const Eigen::Vector3f& point_m) { return T * point_m.cast<double>(); }

Method kilter_method(const Side& source, const Side& target) {
  struct State {
    NearestVoxelSearch source;
    NearestVoxelSearch target;
    State(const Side& from, const Side& onto)
        : source(from.map, kilter::VoxelPosition::kCentroid, kLimit_m),
          target(onto.map, kilter::VoxelPosition::kCentroid, kLimit_m) {}
  };
  const auto state = std::make_shared<std::unique_ptr<State>>();
  return {"kilter",
          [&source, &target, state](const std::vector<Pose3>& poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(source, target);
            for (const Pose3& pose : poses) {
              const auto found = kilter::nearest_of_all((*state)->source, (*state)->target, pose, kLimit_m);
              for (std::size_t i = 0; i < found.size(); ++i) {
                distances_m[i] = found[i].voxel == kilter::kNoVoxel ? kNone : static_cast<float>(found[i].distance_m);
              }
            }
          }};
}

Method one_by_one_method(const Side& source, const Side& target) {
  struct State {
    NearestVoxelSearch search;
    NearestVoxelCursor cursor;
    explicit State(const Side& side) : search(side.map, kilter::VoxelPosition::kCentroid, kLimit_m), cursor(search) {}
  };
  const auto state = std::make_shared<std::unique_ptr<State>>();
  return {"kilter, one by one",
          [&source, &target, state](const std::vector<Pose3>& poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(target);
            std::vector<std::uint32_t> last(source.points_m.size(), kilter::kNoVoxel);
            for (const Pose3& pose : poses) {
              const Eigen::Isometry3d T = pose.isometry();
              for (std::size_t i = 0; i < source.points_m.size(); ++i) {
                const auto found = (*state)->cursor.nearest(moved(T, source.points_m[i]), kLimit_m, last[i]);
                distances_m[i] = found ? static_cast<float>(found->distance_m) : kNone;
                if (found) last[i] = found->voxel;
              }
            }
          }};
}

#ifdef KILTER_HAS_NANOFLANN
struct FlannPoints {
  const std::vector<Eigen::Vector3f>& points_m;

  // nanoflann calls these by their names.
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points_m.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points_m[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

Method nanoflann_method(const Side& source, const Side& target) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, FlannPoints>, FlannPoints, 3>;
  struct State {
    FlannPoints points;
    Tree tree;
    explicit State(const Side& side) : points{side.points_m}, tree(3, points, {10}) {}
  };
  const auto state = std::make_shared<std::unique_ptr<State>>();
  return {"nanoflann",
          [&source, &target, state](const std::vector<Pose3>& poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(target);
            for (const Pose3& pose : poses) {
              const Eigen::Isometry3d T = pose.isometry();
              for (std::size_t i = 0; i < source.points_m.size(); ++i) {
                const Eigen::Vector3f at_m = moved(T, source.points_m[i]).cast<float>();
                std::uint32_t index = 0;
                float square_m2 = 0.0F;
                nanoflann::KNNResultSet<float, std::uint32_t> nearest(1);
                nearest.init(&index, &square_m2);
                square_m2 = static_cast<float>(kLimit_m * kLimit_m);  // nothing farther is looked at
                (*state)->tree.findNeighbors(nearest, at_m.data(), {});
                distances_m[i] = nearest.size() == 0 ? kNone : std::sqrt(square_m2);
              }
            }
          }};
}
#endif

// Of the processor, not of the clock: other work on the machine does not count.
double seconds(const std::function<void()>& work) {
  const auto now = [] {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// Largest difference from brute force over some hundred points. [m]
double largest_error_m(const Side& source, const Side& target, const Pose3& pose,
                       const std::vector<float>& distances_m) {
  double largest_m = 0.0;
  const std::size_t stride = std::max<std::size_t>(1, source.points_m.size() / 500);
  for (std::size_t i = 0; i < source.points_m.size(); i += stride) {
    const Eigen::Vector3d at_m = moved(pose.isometry(), source.points_m[i]);
    double least_m = kLimit_m;
    bool any = false;
    for (const Eigen::Vector3f& point_m : target.points_m) {
      const double distance_m = (point_m.cast<double>() - at_m).norm();
      any = any || distance_m <= least_m;
      least_m = std::min(least_m, distance_m);
    }
    const double expected_m = any ? least_m : static_cast<double>(kNone);
    largest_m = std::max(largest_m, std::abs(expected_m - static_cast<double>(distances_m[i])));
  }
  return largest_m;
}

bool read_side(const std::string& file, Side& side) {
  const auto cloud = kilter::read_cloud_file(file);
  if (!cloud) {
    fmt::print(stderr, "{}\n", kilter::to_string(cloud.error()));
    return false;
  }
  std::vector<Eigen::Vector3d> points_m;
  for (const Eigen::Vector3f& point_m : cloud->points_m) points_m.push_back(point_m.cast<double>());
  kilter::MapBuilder builder({.resolution_m = 0.1});
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

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: kilter_distances_benchmark NAME TARGET.pcd SOURCE.pcd POSES.tum\n");
    return 2;
  }
  Side target;
  Side source;
  const auto poses = kilter::read_file(argv[4]);
  if (!poses || !read_side(argv[2], target) || !read_side(argv[3], source)) return 2;
  const auto T_world_submap = kilter::read_poses(poses->view(), argv[4]);
  if (!T_world_submap || T_world_submap->size() < 2) return 2;
  const Pose3 T_target_source = (*T_world_submap)[0].inverse() * (*T_world_submap)[1];
  std::vector<Method> methods = {kilter_method(source, target), one_by_one_method(source, target)};
#ifdef KILTER_HAS_NANOFLANN
  methods.push_back(nanoflann_method(source, target));
#endif
  const std::vector<Pose3> one = {T_target_source};
  const std::vector<Pose3> many = poses_around(T_target_source);
  struct Times {
    std::vector<double> cold, often, warm;
  };
  std::vector<Times> times(methods.size());
  std::vector<double> error_m(methods.size(), 0.0);
  std::vector<float> distances_m(source.points_m.size());
  std::size_t within = 0;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      times[m].often.push_back(seconds([&] { methods[m].run(many, distances_m, true); }));
      times[m].cold.push_back(seconds([&] { methods[m].run(one, distances_m, true); }));
      times[m].warm.push_back(seconds([&] { methods[m].run(one, distances_m, false); }));
      if (round > 0) continue;
      error_m[m] = largest_error_m(source, target, T_target_source, distances_m);
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
    fmt::print("| {}, {} | {} to {} | {:.0f} % | {} | {} | {} | {:.1e} m |\n", argv[1], methods[m].name,
               source.points_m.size(), target.points_m.size(), 100.0 * static_cast<double>(within) / points,
               cell(&Times::cold, points), cell(&Times::often, kPoses * points), cell(&Times::warm, points),
               error_m[m]);
  }
  return 0;
}
