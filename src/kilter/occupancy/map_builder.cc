// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/map_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kilter/occupancy/surface_normals.h"

namespace kilter {
namespace {

// Rays that are traced between two questions whether to go on pass at most so many: some hundredths of a second, and a
// few hundred megabytes if no two of them share a block.
constexpr double kVoxelsBetweenQuestions = 6e6;
// Of one scan: places in its marks are 32 bits. A window of so few bits never holds more.
constexpr std::size_t kMostMarkBytes = std::size_t{3} << 30;
constexpr int kBitsOfFewMarks = 22;
constexpr std::size_t kHitsBetweenQuestions = 1'000'000;  // half a gigabyte if no two share a block
// Of a cloud's point while it is taken: twice where a ray ends, and a hit.
constexpr std::size_t kBytesAReturn = 2 * 3 * sizeof(float) + sizeof(HitSums::Hit);

template <typename Take>
void move_some_at_a_time(std::span<const Eigen::Vector3f> points_m, const Pose3& T_map_cloud, const Take& take) {
  constexpr std::size_t kSome = 4096;
  const Eigen::Isometry3d T = T_map_cloud.isometry();
  std::vector<Eigen::Vector3d> some_m;
  some_m.reserve(std::min(kSome, points_m.size()));
  for (std::size_t first = 0; first < points_m.size(); first += kSome) {
    some_m.clear();
    for (const Eigen::Vector3f& point_m : points_m.subspan(first, std::min(kSome, points_m.size() - first))) {
      some_m.emplace_back(T * point_m.cast<double>());
    }
    take(some_m);
  }
}

}  // namespace

Error too_much_of_a_scan(std::string where) {
  return {
      ErrorCode::kUnsupported,
      fmt::format("expected a cloud that touches at most {:.0f} million cubes of {} voxels across, and it does more",
                  static_cast<double>(kMostMarkBytes) / kBlockVoxels / 1e6, kBlockSize),
      std::move(where), "use a coarser resolution or a smaller max_range, or leave points far from all others out"};
}

MapBuilder::MapBuilder(const OccupancyOptions& options) : MapBuilder(options, vector_paths().back()) {}

MapBuilder::MapBuilder(const OccupancyOptions& options, VectorPath path)
    : options_(options), kernels_(ray_kernels(path)), blocks_(LogOddsModel(options)), hits_(options.resolution_m) {}

bool MapBuilder::insert_scan(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& origin_m,
                             const KeepGoing& keep_going) {
  if (!begin_scan(origin_m, points_m.size())) return true;
  take_returns(points_m, origins_m_.back());
  return finish_scan(keep_going);
}

bool MapBuilder::insert_scan(std::span<const Eigen::Vector3f> points_m, const Pose3& T_map_scan,
                             const KeepGoing& keep_going) {
  if (keep_going && !keep_going(held_bytes() + points_m.size() * kBytesAReturn)) return false;
  if (!begin_scan(T_map_scan.translation_m(), points_m.size())) return true;
  move_some_at_a_time(points_m, T_map_scan, [&](const auto& some_m) { take_returns(some_m, origins_m_.back()); });
  return finish_scan(keep_going);
}

bool MapBuilder::insert_points(std::span<const Eigen::Vector3d> points_m, const KeepGoing& keep_going) {
  ends_m_.clear_for(points_m.size());
  take_points(points_m);
  return finish_points(keep_going);
}

bool MapBuilder::insert_points(std::span<const Eigen::Vector3f> points_m, const Pose3& T_map_cloud,
                               const KeepGoing& keep_going) {
  if (keep_going && !keep_going(held_bytes() + points_m.size() * kBytesAReturn)) return false;
  ends_m_.clear_for(points_m.size());
  move_some_at_a_time(points_m, T_map_cloud, [&](const auto& some_m) { take_points(some_m); });
  return finish_points(keep_going);
}

// \return false if all of the scan is left out.
bool MapBuilder::begin_scan(const Eigen::Vector3d& origin_m, std::size_t points) {
  if (!on_lattice(origin_m, options_.resolution_m)) {
    points_off_lattice_ += points;
    return false;
  }
  has_free_space_ = true;
  origins_m_.push_back(origin_m.cast<float>());
  ends_m_.clear_for(points);
  beyond_m_.clear_for(points);
  return true;
}

bool MapBuilder::finish_scan(const KeepGoing& keep_going) {
  const Eigen::Vector3f from_m = origins_m_.back();
  const std::size_t hits = ends_m_.count;
  hits_.sum_up_if_many(origins_m_);
  for (std::size_t i = 0; i < beyond_m_.count; ++i) ends_m_.add(beyond_m_[i]);
  Eigen::AlignedBox3f box_m(from_m);
  for (std::size_t i = 0; i < ends_m_.count; ++i) box_m.extend(ends_m_[i]);
  open_window(box_m);
  if (!trace(from_m, keep_going) || !mark_hits(hits, keep_going)) return false;
  apply_marks();
  return true;
}

bool MapBuilder::finish_points(const KeepGoing& keep_going) {
  hits_.sum_up_if_many(origins_m_);
  if (ends_m_.count == 0) return true;
  Eigen::AlignedBox3f box_m;
  for (std::size_t i = 0; i < ends_m_.count; ++i) box_m.extend(ends_m_[i]);
  open_window(box_m);
  if (!mark_hits(ends_m_.count, keep_going)) return false;
  apply_marks();
  return true;
}

// What is marked is copied into blocks before it is forgotten.
std::size_t MapBuilder::held_bytes() const {
  return blocks_.held_bytes() + 2 * marks_.held_bytes() + hits_.held_bytes();
}

// The first `count` ends some at a time: marks do not depend on what is marked together.
template <typename Mark>
bool MapBuilder::mark_in_parts(std::size_t count, std::size_t at_once, const KeepGoing& keep_going, const Mark& mark) {
  for (std::size_t first = 0; first < count; first += at_once) {
    const std::size_t last = std::min(first + at_once, count);
    some_ends_m_.clear_for(last - first);
    for (std::size_t i = first; i < last; ++i) some_ends_m_.add(ends_m_[i]);
    mark(some_ends_m_);
    if (keep_going && !keep_going(held_bytes())) return false;
    if (marks_.held_bytes() > kMostMarkBytes) return false;
  }
  return true;
}

// A scan's rays, some at a time if somebody asks or their marks may be too many.
bool MapBuilder::trace(const Eigen::Vector3f& from_m, const KeepGoing& keep_going) {
  const auto mark = kernels().trace;
  const double voxels_a_ray = 3.0 * options_.max_range_m / options_.resolution_m;
  const auto at_once = static_cast<std::size_t>(std::clamp(kVoxelsBetweenQuestions / voxels_a_ray, 1.0, 1e6));
  const bool may_be_many = keep_going || marks_.window().total_bits() > kBitsOfFewMarks;
  if (!may_be_many || ends_m_.count <= at_once) {
    mark(from_m, ends_m_, options_.resolution_m, marks_);
    return !keep_going || keep_going(held_bytes());
  }
  return mark_in_parts(ends_m_.count, at_once, keep_going,
                       [&](const RayEnds& some_m) { mark(from_m, some_m, options_.resolution_m, marks_); });
}

bool MapBuilder::mark_hits(std::size_t count, const KeepGoing& keep_going) {
  const auto mark = kernels().mark_hits;
  if (count <= kHitsBetweenQuestions) {
    mark(ends_m_, count, options_.resolution_m, marks_);
    return true;
  }
  return mark_in_parts(count, kHitsBetweenQuestions, keep_going,
                       [&](const RayEnds& some_m) { mark(some_m, some_m.count, options_.resolution_m, marks_); });
}

void MapBuilder::take_points(std::span<const Eigen::Vector3d> points_m) {
  for (const Eigen::Vector3d& point_m : points_m) {
    if (!on_lattice(point_m, options_.resolution_m)) {
      ++points_off_lattice_;
      continue;
    }
    const Eigen::Vector3f at_m = point_m.cast<float>();
    hits_.add({at_m, HitSums::kNoOrigin});
    ends_m_.add(at_m);
  }
}

// Sorts out which points are returns and where their rays end.
void MapBuilder::take_returns(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3f& origin_m) {
  const auto origin = static_cast<std::uint32_t>(origins_m_.size() - 1);
  for (const Eigen::Vector3d& point_m : points_m) {
    if (!on_lattice(point_m, options_.resolution_m)) {
      ++points_off_lattice_;
      continue;
    }
    const Eigen::Vector3f to_m = point_m.cast<float>();
    const double range_m = ray_length_m(to_m - origin_m);
    if (!(range_m >= options_.min_range_m) || range_m == 0.0) continue;
    if (range_m <= options_.max_range_m) {
      hits_.add({to_m, origin});
      ends_m_.add(to_m);
      continue;
    }
    const Eigen::Vector3f direction = (to_m - origin_m) / static_cast<float>(range_m);
    const Eigen::Vector3f end_m = origin_m + direction * static_cast<float>(options_.max_range_m);
    if (on_lattice(end_m.cast<double>(), options_.resolution_m)) beyond_m_.add(end_m);
  }
}

// A block more on every side, into which rays may be led by rounding.
void MapBuilder::open_window(const Eigen::AlignedBox3f& box_m) {
  const Eigen::Vector3i low = block_of(voxel_at(box_m.min().cast<double>(), options_.resolution_m));
  const Eigen::Vector3i high = block_of(voxel_at(box_m.max().cast<double>(), options_.resolution_m));
  marks_.begin(low - Eigen::Vector3i::Ones(), high + Eigen::Vector3i::Ones());
}

RayKernels MapBuilder::kernels() const { return marks_.is_dense() ? kernels_ : ray_kernels_one_by_one(); }

void MapBuilder::apply_marks() {
  marks_.take([&](const Eigen::Vector3i& block, BlockStore::Marks marks) { blocks_.apply(block, marks); });
}

VoxelMap MapBuilder::finish() {
  marks_ = {};
  BlockStore::Finished finished = blocks_.finish(!has_free_space_);
  SurfaceVoxels voxels = hits_.summarise(finished.blocks, origins_m_);
  voxels.log_odds = std::move(finished.log_odds);
  hits_ = HitSums(options_.resolution_m);
  VoxelMap map(options_.resolution_m, has_free_space_, std::move(finished.blocks), std::move(voxels));
  origins_m_.clear();
  has_free_space_ = false;
  return with_surface_normals(map);
}

}  // namespace kilter
