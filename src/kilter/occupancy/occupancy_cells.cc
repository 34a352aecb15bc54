// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/occupancy_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "kilter/occupancy/key_numbers.h"
#include "kilter/occupancy/surface_normals.h"

namespace kilter {
namespace {

// How far pruned leaves may expand: a few bytes must not become minutes of work, so what goes beyond a small map has to
// be borne out by many cells. Blocks are 144 bytes each, occupied voxels cost a microsecond or two.
constexpr std::uint64_t kBlocksOfAny = std::uint64_t{1} << 19;
constexpr std::uint64_t kBlocksPerCell = 8;
constexpr std::uint64_t kSurfaceOfAny = std::uint64_t{1} << 18;
constexpr std::uint64_t kSurfacePerCell = 512;
// Files give a resolution with six digits; what differs by less is the same lattice.
constexpr double kSameResolution = 1e-6;
constexpr int kFreeSideRadius = 2;

float log_odds_of(double probability) { return static_cast<float>(std::log(probability / (1.0 - probability))); }

// Voxels from `first` to `last`, both included.
struct VoxelRange {
  VoxelIndex first;
  VoxelIndex last;

  [[nodiscard]] std::uint64_t voxels() const { return product(first, last); }
  [[nodiscard]] std::uint64_t blocks() const { return product(block_of(first), block_of(last)); }

  static std::uint64_t product(const Eigen::Vector3i& from, const Eigen::Vector3i& to) {
    const Eigen::Vector3i size = to - from + Eigen::Vector3i::Ones();
    return static_cast<std::uint64_t>(size.x()) * static_cast<std::uint64_t>(size.y()) *
           static_cast<std::uint64_t>(size.z());
  }
};

// The part of an 8 x 8 layer that lies between two corners of a block.
std::uint64_t layer_mask(const Eigen::Vector3i& from, const Eigen::Vector3i& to) {
  const std::uint64_t row = (0xFFULL >> (7 - to.x())) & (0xFFULL << from.x());
  std::uint64_t mask = 0;
  for (int y = from.y(); y <= to.y(); ++y) mask |= row << (8 * y);
  return mask;
}

// Blocks that grow as cells fall into them.
class BlockFiller {
 public:
  BlockFiller(double resolution_m, float threshold, std::size_t cells)
      : resolution_m_(resolution_m),
        threshold_(threshold),
        most_blocks_(kBlocksOfAny + kBlocksPerCell * cells),
        most_surface_(kSurfaceOfAny + kSurfacePerCell * cells) {}

  [[nodiscard]] std::uint64_t most_blocks() const { return most_blocks_; }
  [[nodiscard]] std::uint64_t most_surface() const { return most_surface_; }

  // \return false if the range is too much for one map.
  bool fill(const VoxelRange& range, float log_odds) {
    const bool occupied = log_odds >= threshold_;
    if (!occupied && log_odds >= 0.0F) return true;  // neither is known
    if (blocks_.size() + range.blocks() > most_blocks_) return false;
    if (occupied && surface_.size() + range.voxels() > most_surface_) return false;
    const Eigen::Vector3i first = block_of(range.first);
    const Eigen::Vector3i last = block_of(range.last);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) fill_block({x, y, z}, range, log_odds, occupied);
      }
    }
    return true;
  }

  VoxelMap finish(double cell_m);

 private:
  struct SurfaceVoxel {
    std::uint32_t block;
    std::uint16_t bit;
    float log_odds;
  };

  void fill_block(const Eigen::Vector3i& at, const VoxelRange& range, float log_odds, bool occupied) {
    const Eigen::Vector3i corner = at * kBlockSize;
    const Eigen::Vector3i from = (range.first - corner).cwiseMax(0);
    const Eigen::Vector3i to = (range.last - corner).cwiseMin(kBlockSize - 1);
    const std::uint64_t mask = layer_mask(from, to);
    const std::uint32_t number = touch(block_key(at));
    auto& layers = occupied ? blocks_[number].occupied : blocks_[number].free;
    for (int z = from.z(); z <= to.z(); ++z) {
      layers[static_cast<std::size_t>(z)] |= mask;
      if (!occupied) continue;
      for (std::uint64_t bits = mask; bits != 0; bits &= bits - 1) {
        surface_.push_back({number, static_cast<std::uint16_t>(std::countr_zero(bits) + 64 * z), log_odds});
      }
    }
  }

  std::uint32_t touch(std::uint64_t key) {
    const std::uint32_t number = numbers_.find_or_add(key);
    if (number == blocks_.size()) blocks_.emplace_back().key = key;
    return number;
  }

  void sort_blocks();
  [[nodiscard]] SurfaceVoxels surface_in_order();

  double resolution_m_;
  float threshold_;
  std::uint64_t most_blocks_;
  std::uint64_t most_surface_;
  KeyNumbers numbers_;
  std::vector<VoxelBlock> blocks_;  // by number
  std::vector<SurfaceVoxel> surface_;
};

// By key; what surface voxels say of their block follows.
void BlockFiller::sort_blocks() {
  std::vector<std::uint32_t> order(blocks_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return blocks_[a].key < blocks_[b].key; });
  std::vector<VoxelBlock> sorted;
  sorted.reserve(blocks_.size());
  std::vector<std::uint32_t> place(blocks_.size());
  for (const std::uint32_t number : order) {
    place[number] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(blocks_[number]);
  }
  blocks_ = std::move(sorted);
  for (SurfaceVoxel& voxel : surface_) voxel.block = place[voxel.block];
}

// One entry a voxel: the most occupied of what fell into it.
SurfaceVoxels BlockFiller::surface_in_order() {
  std::sort(surface_.begin(), surface_.end(), [](const SurfaceVoxel& a, const SurfaceVoxel& b) {
    return std::tuple(a.block, a.bit, -a.log_odds) < std::tuple(b.block, b.bit, -b.log_odds);
  });
  const auto same = [](const SurfaceVoxel& a, const SurfaceVoxel& b) { return a.block == b.block && a.bit == b.bit; };
  surface_.erase(std::unique(surface_.begin(), surface_.end(), same), surface_.end());
  SurfaceVoxels voxels;
  voxels.centroids_m.reserve(surface_.size());
  voxels.log_odds.reserve(surface_.size());
  for (const SurfaceVoxel& voxel : surface_) {
    const VoxelIndex index = voxel_of(block_of_key(blocks_[voxel.block].key), voxel.bit);
    voxels.centroids_m.push_back(voxel_centre(index, resolution_m_).cast<float>());
    voxels.log_odds.push_back(voxel.log_odds);
  }
  voxels.normals.assign(surface_.size(), Eigen::Vector3f::Zero());
  voxels.planarity.assign(surface_.size(), 0.0F);
  voxels.seen_at.assign(surface_.size(), 0);
  voxels.hits.assign(surface_.size(), 1);
  return voxels;
}

VoxelMap BlockFiller::finish(double cell_m) {
  sort_blocks();
  SurfaceVoxels voxels = surface_in_order();
  voxels.cell_m = cell_m;
  bool has_free_space = false;
  std::uint32_t next = 0;
  for (VoxelBlock& block : blocks_) {
    block.first_voxel = next;
    for (std::size_t z = 0; z < kBlockSize; ++z) {
      block.free[z] &= ~block.occupied[z];
      has_free_space = has_free_space || block.free[z] != 0;
      next += static_cast<std::uint32_t>(std::popcount(block.occupied[z]));
    }
    block.voxel_count = next - block.first_voxel;
  }
  return {resolution_m_, has_free_space, std::move(blocks_), std::move(voxels)};
}

// Where a surface was seen from: the side on which space around a voxel is free. Zero where that says nothing.
Eigen::Vector3f free_side(const VoxelMap& map, const VoxelIndex& voxel) {
  Eigen::Vector3i side = Eigen::Vector3i::Zero();
  for (int z = -kFreeSideRadius; z <= kFreeSideRadius; ++z) {
    for (int y = -kFreeSideRadius; y <= kFreeSideRadius; ++y) {
      for (int x = -kFreeSideRadius; x <= kFreeSideRadius; ++x) {
        const Eigen::Vector3i offset(x, y, z);
        if (map.state(voxel + offset) == CellState::kFree) side += offset;
      }
    }
  }
  return side.cast<float>();
}

// Normals of points alone may point either way; free space tells the side, as a sensor's place would.
VoxelMap with_oriented_normals(const VoxelMap& map) {
  if (!map.has_free_space()) return with_surface_normals(map);
  SurfaceVoxels voxels = map.voxels();
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels.normals[i] = free_side(map, map.indices()[i]);
  return with_surface_normals(
      {map.resolution_m(), true, {map.blocks().begin(), map.blocks().end()}, std::move(voxels)});
}

// The voxels of a cell, in a lattice of which one of its own cells measures `scale` voxels.
VoxelRange range_of(const OccupancyCell& cell, double scale) {
  const double edge = std::ldexp(scale, cell.level);
  const Eigen::Vector3d low = Eigen::Vector3d(cell.index[0], cell.index[1], cell.index[2]) * scale;
  if (edge < 1.0) {
    const VoxelIndex at = (low.array() + 0.5 * edge).floor().matrix().cast<int>();
    return {at, at};
  }
  const VoxelIndex first = (low.array() - 0.5).ceil().matrix().cast<int>();
  const VoxelIndex end = (low.array() + (edge - 0.5)).ceil().matrix().cast<int>();
  return {first, end - VoxelIndex::Ones()};
}

bool on_lattice(const OccupancyCell& cell, double scale) {
  const double edge = std::ldexp(scale, cell.level);
  return std::all_of(cell.index.begin(), cell.index.end(), [&](std::int16_t low) {
    return std::abs(low * scale) < kMaxVoxelIndex - 1 && std::abs(low * scale + edge) < kMaxVoxelIndex - 1;
  });
}

// Edge of the smallest occupied cell, in cells of level 0: where a tree knows all surfaces by larger ones, so good they
// are. Leaves that were pruned, whose eight cells are each known to be occupied, do not spoil the others.
double finest_edge(const OccupancyCells& known, float threshold) {
  int level = std::numeric_limits<std::uint8_t>::max();
  for (const OccupancyCell& cell : known.cells) {
    if (cell.log_odds >= threshold) level = std::min<int>(level, cell.level);
  }
  return level == std::numeric_limits<std::uint8_t>::max() ? 1.0 : std::ldexp(1.0, level);
}

}  // namespace

Expected<VoxelMap> map_from_cells(const OccupancyCells& known, const OccupancyOptions& options) {
  double scale = known.resolution_m / options.resolution_m;
  if (std::abs(scale - 1.0) < kSameResolution) scale = 1.0;
  const float threshold = log_odds_of(options.occupancy_threshold);
  BlockFiller filler(options.resolution_m, threshold, known.cells.size());
  for (const OccupancyCell& cell : known.cells) {
    if (!on_lattice(cell, scale)) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("a cell lies {} m from the origin or farther, more than kilter's lattice holds at {} m",
                              kMaxVoxelIndex * options.resolution_m, options.resolution_m),
                  {}, "use a coarser resolution");
    }
    if (!filler.fill(range_of(cell, scale), cell.log_odds)) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("at {} m its {} cells fill more than {} blocks of 8 x 8 x 8 voxels, or hold more than {} "
                              "occupied voxels; one is a cube of {:.6g} m",
                              options.resolution_m, known.cells.size(), filler.most_blocks(), filler.most_surface(),
                              std::ldexp(known.resolution_m, cell.level)),
                  {}, "a submap reaches no farther than its sensor saw: cut it smaller, or use a coarser resolution");
    }
  }
  const double cell_m = options.resolution_m * std::max(1.0, scale * finest_edge(known, threshold));
  return with_oriented_normals(filler.finish(cell_m));
}

Expected<OccupancyCell> cell_of_voxel(const VoxelIndex& voxel, double resolution_m, float log_odds) {
  using Limits = std::numeric_limits<std::int16_t>;
  OccupancyCell cell{{}, 0, log_odds};
  for (int axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < Limits::min() || voxel[axis] > Limits::max()) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("a voxel lies {:.1f} m from the origin; at {} m an octree file reaches {:.1f} m",
                              std::abs(voxel[axis]) * resolution_m, resolution_m, (Limits::max() + 1) * resolution_m));
    }
    cell.index[static_cast<std::size_t>(axis)] = static_cast<std::int16_t>(voxel[axis]);
  }
  return cell;
}

Expected<OccupancyCells> cells_from_map(const VoxelMap& map, float free_log_odds) {
  OccupancyCells known{map.resolution_m(), {}};
  for (const VoxelBlock& block : map.blocks()) {
    const Eigen::Vector3i at = block_of_key(block.key);
    for (int bit = 0; bit < kBlockVoxels; ++bit) {
      const auto layer = static_cast<std::size_t>(bit >> 6);
      const std::uint64_t mask = std::uint64_t{1} << (bit & 63);
      const bool occupied = (block.occupied[layer] & mask) != 0;
      if (!occupied && (block.free[layer] & mask) == 0) continue;
      const float log_odds =
          occupied ? map.voxels().log_odds[block.first_voxel + rank_in_block(block, bit)] : free_log_odds;
      const Expected<OccupancyCell> cell = cell_of_voxel(voxel_of(at, bit), known.resolution_m, log_odds);
      if (!cell) return pass_up(cell.error());
      known.cells.push_back(*cell);
    }
  }
  return known;
}

}  // namespace kilter
