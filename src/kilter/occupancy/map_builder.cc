// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/map_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "kilter/base/contract.h"
#include "kilter/occupancy/surface_normals.h"

namespace kilter {
namespace {

// Rays that are traced between two questions whether to go on pass at most so many: some hundredths of a second, and a
// few hundred megabytes if no two of them share a block.
constexpr double kVoxelsBetweenQuestions = 6e6;
// Of one scan: places in its marks are 32 bits.
constexpr std::size_t kMostMarkBytes = std::size_t{3} << 30;
constexpr std::uint32_t kNoOrigin = std::numeric_limits<std::uint32_t>::max();

bool on_lattice(const Eigen::Vector3d& point_m, double resolution_m) {
  const double end_m = resolution_m * (kMaxVoxelIndex - 1);
  return std::abs(point_m.x()) < end_m && std::abs(point_m.y()) < end_m && std::abs(point_m.z()) < end_m;
}

}  // namespace

MapBuilder::MapBuilder(const OccupancyOptions& options) : MapBuilder(options, vector_paths().back()) {}

MapBuilder::MapBuilder(const OccupancyOptions& options, VectorPath path)
    : options_(options), kernels_(ray_kernels(path)), blocks_(LogOddsModel(options)) {}

bool MapBuilder::insert_scan(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& origin_m,
                             const KeepGoing& keep_going) {
  if (!on_lattice(origin_m, options_.resolution_m)) {
    points_off_lattice_ += points_m.size();
    return true;
  }
  has_free_space_ = true;
  const Eigen::Vector3f from_m = origin_m.cast<float>();
  origins_m_.push_back(from_m);
  const std::size_t hits = take_returns(points_m, from_m);
  Eigen::AlignedBox3f box_m(from_m);
  for (std::size_t i = 0; i < ends_m_.count; ++i) box_m.extend(ends_m_[i]);
  open_window(box_m);
  if (!trace(from_m, keep_going)) return false;
  kernels().mark_hits(ends_m_, hits, options_.resolution_m, marks_);
  apply_marks();
  return true;
}

// What is marked is copied into blocks before it is forgotten.
std::size_t MapBuilder::held_bytes() const {
  return blocks_.held_bytes() + 2 * marks_.held_bytes() + hits_.size() * sizeof(Hit);
}

// A scan's rays, some at a time if somebody asks: marks do not depend on what is traced together.
bool MapBuilder::trace(const Eigen::Vector3f& from_m, const KeepGoing& keep_going) {
  const auto mark = kernels().trace;
  const double voxels_a_ray = 3.0 * options_.max_range_m / options_.resolution_m;
  const auto at_once = static_cast<std::size_t>(std::clamp(kVoxelsBetweenQuestions / voxels_a_ray, 16.0, 1e6));
  if (!keep_going || ends_m_.count <= at_once) {
    mark(from_m, ends_m_, options_.resolution_m, marks_);
    return !keep_going || keep_going(held_bytes());
  }
  for (std::size_t first = 0; first < ends_m_.count; first += at_once) {
    const std::size_t last = std::min(first + at_once, ends_m_.count);
    some_ends_m_.clear_for(last - first);
    for (std::size_t i = first; i < last; ++i) some_ends_m_.add(ends_m_[i]);
    mark(from_m, some_ends_m_, options_.resolution_m, marks_);
    if (!keep_going(held_bytes()) || marks_.held_bytes() > kMostMarkBytes) return false;
  }
  return true;
}

void MapBuilder::insert_points(std::span<const Eigen::Vector3d> points_m) {
  ends_m_.clear_for(points_m.size());
  Eigen::AlignedBox3f box_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    if (!on_lattice(point_m, options_.resolution_m)) {
      ++points_off_lattice_;
      continue;
    }
    hits_.push_back({point_m.cast<float>(), kNoOrigin});
    ends_m_.add(hits_.back().point_m);
    box_m.extend(hits_.back().point_m);
  }
  if (box_m.isEmpty()) return;
  open_window(box_m);
  kernels().mark_hits(ends_m_, ends_m_.count, options_.resolution_m, marks_);
  apply_marks();
}

// Sorts out which points are returns and where their rays end. \return how many are hits, which come first.
std::size_t MapBuilder::take_returns(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3f& origin_m) {
  ends_m_.clear_for(points_m.size());
  beyond_m_.clear_for(points_m.size());
  const auto origin = static_cast<std::uint32_t>(origins_m_.size() - 1);
  const std::size_t first_hit = hits_.size();
  hits_.resize(first_hit + points_m.size());
  Hit* const hits = hits_.data() + first_hit;
  for (const Eigen::Vector3d& point_m : points_m) {
    if (!on_lattice(point_m, options_.resolution_m)) {
      ++points_off_lattice_;
      continue;
    }
    const Eigen::Vector3f to_m = point_m.cast<float>();
    const double range_m = ray_length_m(to_m - origin_m);
    if (!(range_m >= options_.min_range_m) || range_m == 0.0) continue;
    if (range_m <= options_.max_range_m) {
      hits[ends_m_.count] = {to_m, origin};
      ends_m_.add(to_m);
      continue;
    }
    const Eigen::Vector3f direction = (to_m - origin_m) / static_cast<float>(range_m);
    const Eigen::Vector3f end_m = origin_m + direction * static_cast<float>(options_.max_range_m);
    if (on_lattice(end_m.cast<double>(), options_.resolution_m)) beyond_m_.add(end_m);
  }
  const std::size_t count = ends_m_.count;
  hits_.resize(first_hit + count);
  for (std::size_t i = 0; i < beyond_m_.count; ++i) ends_m_.add(beyond_m_[i]);
  return count;
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
  BlockStore::Finished finished = blocks_.finish();
  SurfaceVoxels voxels = summarise_hits(finished.blocks);
  voxels.log_odds = std::move(finished.log_odds);
  std::vector<Hit>().swap(hits_);
  VoxelMap map(options_.resolution_m, has_free_space_, std::move(finished.blocks), std::move(voxels));
  return with_surface_normals(map);
}

// Means of the hits inside each voxel that ended up occupied; `normals` holds the mean viewing direction for now, which
// is what with_surface_normals orients by.
SurfaceVoxels MapBuilder::summarise_hits(const std::vector<VoxelBlock>& occupied) const {
  struct Sums {
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d view = Eigen::Vector3d::Zero();
    double time = 0.0;
    std::uint32_t count = 0;
  };
  std::vector<std::uint64_t> keys(occupied.size());
  std::transform(occupied.begin(), occupied.end(), keys.begin(), [](const VoxelBlock& block) { return block.key; });
  const BlockIndex index(keys);
  const std::size_t count = occupied.empty() ? 0 : occupied.back().first_voxel + occupied.back().voxel_count;
  std::vector<Sums> sums(count);
  for (const Hit& hit : hits_) {
    const Eigen::Vector3d point_m = hit.point_m.cast<double>();
    const VoxelIndex voxel = voxel_at(point_m, options_.resolution_m);
    const std::int32_t number = index.find(block_of(voxel));
    KILTER_EXPECTS(number != BlockIndex::kNone);
    if (number == BlockIndex::kNone) continue;  // cannot be; if it is, a hit is lost rather than memory read
    const VoxelBlock& block = occupied[static_cast<std::size_t>(number)];
    const int bit = bit_of(voxel);
    if ((block.occupied[static_cast<std::size_t>(bit >> 6)] >> (bit & 63) & 1) == 0) continue;
    Sums& sum = sums[block.first_voxel + rank_in_block(block, bit)];
    sum.point_m += point_m;
    ++sum.count;
    if (hit.origin == kNoOrigin) continue;
    sum.view += (origins_m_[hit.origin].cast<double>() - point_m).normalized();
    sum.time += hit.origin;
  }
  SurfaceVoxels voxels;
  voxels.centroids_m.resize(count);
  voxels.normals.resize(count);
  voxels.planarity.assign(count, 0.0F);
  voxels.seen_at.assign(count, 0);
  const double last = origins_m_.size() > 1 ? static_cast<double>(origins_m_.size() - 1) : 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (sums[i].count == 0) continue;
    voxels.seen_at[i] = static_cast<std::uint8_t>(std::lround(255.0 * sums[i].time / sums[i].count / last));
  }
  for (const VoxelBlock& block : occupied) {
    const Eigen::Vector3i at = block_of_key(block.key);
    std::size_t i = block.first_voxel;
    for (int z = 0; z < kBlockSize; ++z) {
      for (std::uint64_t bits = block.occupied[static_cast<std::size_t>(z)]; bits != 0; bits &= bits - 1, ++i) {
        const VoxelIndex voxel = voxel_of(at, std::countr_zero(bits) + 64 * z);
        const Eigen::Vector3d mean_m = sums[i].count > 0 ? Eigen::Vector3d(sums[i].point_m / sums[i].count)
                                                         : voxel_centre(voxel, options_.resolution_m);
        voxels.centroids_m[i] = mean_m.cast<float>();
        voxels.normals[i] = sums[i].view.cast<float>();
      }
    }
  }
  return voxels;
}

}  // namespace kilter
