// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/draw_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_set>

#include "kilter/matching/conflict.h"
#include "kilter/pipeline/pair_schedule.h"

namespace kilter {
namespace {

// Points of a robot's path that are kept.
constexpr std::size_t kMaxPathPoints = 4000;
// Two submaps saw the same place where both have a surface in a cell this large. [m]
constexpr double kCommonCell_m = 0.5;

std::vector<Eigen::Vector3d> thinned_path(const std::vector<Pose3>& T_world_cloud) {
  std::vector<Eigen::Vector3d> path;
  const std::size_t step = T_world_cloud.size() / kMaxPathPoints + 1;
  for (std::size_t i = 0; i < T_world_cloud.size(); i += step) path.push_back(T_world_cloud[i].translation_m());
  if (!T_world_cloud.empty() && (T_world_cloud.size() - 1) % step != 0) {
    path.push_back(T_world_cloud.back().translation_m());
  }
  return path;
}

// Voxels in block order are neighbours in space, so every n-th of them thins evenly.
CloudPicture thinned_cloud(const SurfaceVoxels& voxels, std::size_t all_voxels, std::size_t max_points) {
  CloudPicture cloud;
  cloud.voxels = voxels.size();
  std::size_t kept = voxels.size();
  if (all_voxels > max_points) kept = voxels.size() * max_points / all_voxels;
  if (kept == 0) return cloud;
  const auto centroid_m = [&](std::size_t k) -> Eigen::Vector3d {
    return voxels.centroids_m[k * voxels.size() / kept].cast<double>();
  };
  Eigen::AlignedBox3d box;
  for (std::size_t k = 0; k < kept; ++k) box.extend(centroid_m(k));
  cloud.origin_m = box.min();
  constexpr double kSteps = 65535.0;
  cloud.step_m = box.sizes().maxCoeff() / kSteps;
  cloud.points.resize(kept);
  cloud.misalignment.assign(kept, 0);
  if (cloud.step_m == 0.0) return cloud;  // a single point
  for (std::size_t k = 0; k < kept; ++k) {
    const Eigen::Vector3d steps = (centroid_m(k) - cloud.origin_m) / cloud.step_m;
    for (int axis = 0; axis < 3; ++axis) {
      cloud.points[k][static_cast<std::size_t>(axis)] =
          static_cast<std::uint16_t>(std::clamp(std::round(steps[axis]), 0.0, kSteps));
    }
  }
  return cloud;
}

// Surfaces within the margin of each other are one surface to the free-space picture, as in the measurement.
std::uint8_t sample(const Eigen::Vector3d& at_m, const VoxelMap& map, NearestVoxelCursor& cursor, double max_distance_m,
                    double margin_m) {
  const auto nearest = cursor.nearest(at_m, std::max(max_distance_m, margin_m));
  std::uint8_t byte = SamplePicture::kNothing;
  if (nearest && nearest->distance_m <= max_distance_m) {
    byte = static_cast<std::uint8_t>(std::lround(nearest->distance_m / max_distance_m * SamplePicture::kSteps));
  }
  const bool near_surface = nearest && nearest->distance_m <= margin_m;
  const bool may_be_free = !near_surface && map.has_free_space() && on_lattice(at_m, map.resolution_m());
  if (may_be_free && is_free_with_neighbours(map, voxel_at(at_m, map.resolution_m()))) {
    byte = static_cast<std::uint8_t>(byte | SamplePicture::kThrough);
  }
  return byte;
}

std::vector<std::uint8_t> samples(const CloudPicture& cloud, std::uint32_t stride, const NearestVoxelSearch& other,
                                  const Pose3& T_other_cloud, double max_distance_m, double margin_m) {
  const Eigen::Isometry3d T = T_other_cloud.isometry();
  NearestVoxelCursor cursor(other);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(cloud.points.size() / stride + 1);
  for (std::size_t i = 0; i < cloud.points.size(); i += stride) {
    bytes.push_back(sample(T * cloud.point_m(i), other.map(), cursor, max_distance_m, margin_m));
  }
  return bytes;
}

// Mean of the target's samples that the source saw too.
Eigen::Vector3d sampled_centre_world_m(const PairPicture& pair, const CloudPicture& target, const Pose3& T_world_target,
                                       const Pose3& T_world_source) {
  const std::vector<std::uint8_t>& near = pair.target.before;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    if ((near[k] & SamplePicture::kNothing) == SamplePicture::kNothing) continue;
    sum_m += target.point_m(k * pair.stride);
    ++count;
  }
  if (count == 0) return 0.5 * (T_world_target.translation_m() + T_world_source.translation_m());
  return T_world_target.isometry() * (sum_m / static_cast<double>(count));
}

bool is_sampled(const PairResult& pair) { return pair.score || pair.T_target_source_registered; }

// One stride for all pairs, so that all samples together stay within twice the points.
std::uint32_t sample_stride(const Picture& picture, const Result& result, const PictureOptions& options) {
  std::size_t points = 0;
  for (const PairResult& pair : result.pairs) {
    if (!is_sampled(pair)) continue;
    points += picture.clouds[static_cast<std::size_t>(pair.id.source.value)].points.size();
    points += picture.clouds[static_cast<std::size_t>(pair.id.target.value)].points.size();
  }
  const std::size_t budget = 2 * static_cast<std::size_t>(options.max_points);
  return static_cast<std::uint32_t>(points / budget + 1);
}

// A pair as far as its result alone tells.
PairPicture outlined(const PairResult& pair, std::uint32_t stride) {
  PairPicture drawn;
  drawn.id = pair.id;
  drawn.stride = stride;
  drawn.registered_histogram = pair.registered_histogram;
  if (pair.registered_score) drawn.registered_parent = pair.registered_score->fit.parent;
  return drawn;
}

void draw_samples(const PairResult& pair, const Picture& picture, const PlacedPair& maps, PairPicture& drawn) {
  const CloudPicture& source = picture.clouds[static_cast<std::size_t>(pair.id.source.value)];
  const CloudPicture& target = picture.clouds[static_cast<std::size_t>(pair.id.target.value)];
  const double d_m = pair.max_distance_m;
  const NearestVoxelSearch& in_source = maps.source.searchable.by_centroid();
  const NearestVoxelSearch& in_target = maps.target.searchable.by_centroid();
  const double margin_m = conflict_margin_m(in_source, in_target);
  const auto both = [&](const Pose3& T_target_source, auto member) {
    drawn.source.*member = samples(source, drawn.stride, in_target, T_target_source, d_m, margin_m);
    drawn.target.*member = samples(target, drawn.stride, in_source, T_target_source.inverse(), d_m, margin_m);
  };
  both(pair.T_target_source, &SamplePicture::before);
  if (pair.T_target_source_registered) both(*pair.T_target_source_registered, &SamplePicture::after);
}

Expected<void> draw_pairs(std::span<const SubmapNode> nodes, SubmapStore& store, const Result& result,
                          const PictureOptions& options, const RunContext& run, Picture& picture) {
  const std::uint32_t stride = sample_stride(picture, result, options);
  std::vector<std::size_t> sampled;
  std::vector<PairId> ids;
  for (std::size_t i = 0; i < result.pairs.size(); ++i) {
    picture.pairs.push_back(outlined(result.pairs[i], stride));
    if (!is_sampled(result.pairs[i])) continue;
    sampled.push_back(i);
    ids.push_back(result.pairs[i].id);
  }
  Expected<void> done = for_each_pair(nodes, store, ids, run, [&](std::size_t k, const PlacedPair& maps) {
    draw_samples(result.pairs[sampled[k]], picture, maps, picture.pairs[sampled[k]]);
  });
  if (!done) return done;
  parallel_for(picture.pairs.size(), {run.threads, run.cancelled, {}}, [&](std::size_t i) {
    PairPicture& pair = picture.pairs[i];
    const Pose3& T_world_target = result.submap(pair.id.target).T_world_submap;
    const std::optional<Eigen::Vector3d>& centre_target_m = result.pairs[i].centre_target_m;
    pair.centre_world_m =
        centre_target_m ? T_world_target * *centre_target_m
                        : sampled_centre_world_m(pair, picture.clouds[static_cast<std::size_t>(pair.id.target.value)],
                                                 T_world_target, result.submap(pair.id.source).T_world_submap);
  });
  return {};
}

Expected<void> draw_clouds(SubmapStore& store, const Result& result, const PictureOptions& options,
                           const RunContext& run, Picture& picture) {
  std::size_t all_voxels = 0;
  for (const SubmapSummary& submap : result.submaps) all_voxels += submap.occupied;
  picture.clouds.resize(result.submaps.size());
  return for_each_submap(store, result.submaps.size(), run, [&](std::size_t i, const SearchableMap& searchable) {
    picture.clouds[i] =
        thinned_cloud(searchable.map().voxels(), all_voxels, static_cast<std::size_t>(options.max_points));
  });
}

std::uint64_t place_of(const Eigen::Vector3d& point_m) {
  const Eigen::Array3d cell = (point_m / kCommonCell_m).array().floor() + double{1 << 20};
  const auto part = [](double value) {
    return static_cast<std::uint64_t>(std::clamp(value, 0.0, double{(1 << 21) - 1}));
  };
  return part(cell.x()) << 42 | part(cell.y()) << 21 | part(cell.z());
}

using Places = std::unordered_set<std::uint64_t>;  // asked, never walked through

Places places_of(const CloudPicture& cloud) {
  Places places;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) places.insert(place_of(cloud.point_m(i)));
  return places;
}

void raise_misalignment(CloudPicture& cloud, const Places& other, const Pose3& T_other_cloud,
                        const Pose3& T_other_cloud_registered) {
  const Eigen::Isometry3d T = T_other_cloud.isometry();
  const Eigen::Isometry3d T_registered = T_other_cloud_registered.isometry();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d point_m = cloud.point_m(i);
    const Eigen::Vector3d at_m = T_registered * point_m;
    if (!other.contains(place_of(at_m))) continue;
    const double steps = std::round((at_m - T * point_m).norm() / Picture::kMisalignmentStep_m);
    cloud.misalignment[i] = std::max(cloud.misalignment[i], static_cast<std::uint8_t>(1.0 + std::min(steps, 254.0)));
  }
}

// Numbers of the pairs that each submap is in whose registration is believed: of others nobody knows how far they are
// off.
std::vector<std::vector<std::size_t>> believed_pairs_by_submap(const Result& result) {
  std::vector<std::vector<std::size_t>> pairs(result.submaps.size());
  for (std::size_t k = 0; k < result.pairs.size(); ++k) {
    const PairResult& pair = result.pairs[k];
    if (!pair.T_target_source_registered || !pair.trusted) continue;
    pairs[static_cast<std::size_t>(pair.id.source.value)].push_back(k);
    pairs[static_cast<std::size_t>(pair.id.target.value)].push_back(k);
  }
  return pairs;
}

void draw_misalignment(Picture& picture, const Result& result, const RunContext& run) {
  std::vector<Places> places(picture.clouds.size());
  parallel_for(places.size(), run, [&](std::size_t i) { places[i] = places_of(picture.clouds[i]); });
  const std::vector<std::vector<std::size_t>> pairs = believed_pairs_by_submap(result);
  parallel_for(picture.clouds.size(), run, [&](std::size_t i) {
    for (const std::size_t k : pairs[i]) {
      const PairResult& pair = result.pairs[k];
      const auto s = static_cast<std::size_t>(pair.id.source.value);
      const auto t = static_cast<std::size_t>(pair.id.target.value);
      const Pose3& T = pair.T_target_source;
      const Pose3& T_registered = *pair.T_target_source_registered;
      if (i == s) raise_misalignment(picture.clouds[i], places[t], T, T_registered);
      if (i == t) raise_misalignment(picture.clouds[i], places[s], T.inverse(), T_registered.inverse());
    }
  });
}

}  // namespace

std::vector<OptionField> fields(PictureOptions& o) {
  return {count_option("report_max_points", o.max_points, 1000, 100000000,
                       "points of all submaps together that report and archive show; more are thinned evenly")};
}

Expected<Picture> draw_picture(std::span<const RobotLog> robots, std::span<const SubmapNode> nodes, SubmapStore& store,
                               const Result& result, const PictureOptions& options, const RunContext& run) {
  Picture picture;
  if (!result.pairs.empty()) picture.max_distance_m = result.pairs.front().max_distance_m;
  for (const RobotLog& robot : robots) picture.paths.push_back(thinned_path(robot.T_world_cloud));
  const std::size_t clouds = result.submaps.size();
  const auto sampled = std::count_if(result.pairs.begin(), result.pairs.end(), is_sampled);
  const std::size_t total = clouds + static_cast<std::size_t>(sampled);
  const RunContext first = part_of(run, 0, total);
  const RunContext second = part_of(run, clouds, total);
  if (auto done = draw_clouds(store, result, options, first, picture); !done) return pass_up(done.error());
  draw_misalignment(picture, result, {run.threads, run.cancelled, {}});
  if (auto done = draw_pairs(nodes, store, result, options, second, picture); !done) return pass_up(done.error());
  return picture;
}

}  // namespace kilter
