// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/voxel_clusters.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kilter/matching/registers.h"

namespace kilter {
namespace {

constexpr int kHalf = kBlockSize / 2;
constexpr std::size_t kClusters = 8;  // of a block; bits of their numbers say upper x, y and z

// For each cell of a layer, whether it lies in the upper half along x (1) and y (2).
constexpr std::array<std::uint8_t, 64> kQuadrants = [] {
  std::array<std::uint8_t, 64> quadrants{};
  for (std::size_t bit = 0; bit < quadrants.size(); ++bit) {
    quadrants[bit] = static_cast<std::uint8_t>((bit >> 2 & 1) | (bit >> 5 & 1) << 1);
  }
  return quadrants;
}();

// How many voxels each cluster of a block has: bits are added up in nibbles, which are half rows, then in bytes.
std::array<std::uint32_t, kClusters> voxels_in_clusters(const VoxelBlock& block) {
  constexpr std::uint64_t kPairs = 0x5555555555555555;
  constexpr std::uint64_t kNibbles = 0x3333333333333333;
  constexpr std::uint64_t kBytes = 0x0F0F0F0F0F0F0F0F;
  std::array<std::uint32_t, kClusters> counts{};
  for (std::size_t half = 0; half < 2; ++half) {
    std::array<std::uint64_t, 2> rows{};  // a byte for each row: its lower and its upper half
    for (std::size_t z = kHalf * half, end = z + kHalf; z < end; ++z) {
      std::uint64_t layer = block.occupied[z];
      layer -= layer >> 1 & kPairs;
      layer = (layer & kNibbles) + (layer >> 2 & kNibbles);
      rows[0] += layer & kBytes;
      rows[1] += layer >> 4 & kBytes;
    }
    const auto sum_of_bytes = [](std::uint64_t four) { return static_cast<std::uint32_t>(four) * 0x01010101U >> 24; };
    for (std::size_t x = 0; x < 2; ++x) {
      counts[4 * half + x] = sum_of_bytes(rows[x]);
      counts[4 * half + 2 + x] = sum_of_bytes(rows[x] >> 32);
    }
  }
  return counts;
}

struct Extent {
  float low_m = 0.0F;
  float high_m = 0.0F;
};

// Of points [first, end) of a column; not of none.
Extent extent_of(const std::vector<float>& column_m, std::uint32_t first, std::uint32_t end) {
  using Floats = Register<4>::Floats;
  constexpr std::uint32_t kLanes = 4;
  if (end - first < kLanes) {
    Extent extent{column_m[first], column_m[first]};
    for (std::uint32_t i = first + 1; i < end; ++i) {
      extent.low_m = std::min(extent.low_m, column_m[i]);
      extent.high_m = std::max(extent.high_m, column_m[i]);
    }
    return extent;
  }
  Floats low;
  std::memcpy(&low, column_m.data() + end - kLanes, sizeof(low));
  Floats high = low;
  for (std::uint32_t i = first; i + kLanes < end; i += kLanes) {
    Floats lanes;
    std::memcpy(&lanes, column_m.data() + i, sizeof(lanes));
    low = lanes < low ? lanes : low;
    high = lanes > high ? lanes : high;
  }
  return {-largest_of<kLanes>(-low), largest_of<kLanes>(high)};
}

// A table of octets pays while it is not much more than the blocks. Numbers of blocks must fit above an octet's bits.
constexpr double kOctetsPerBlock = 16;
constexpr double kOctetsAlways = 8192;
constexpr std::size_t kMostBlocks = 1 << 24;

constexpr std::array<std::uint8_t, 256> kOnes = [] {
  std::array<std::uint8_t, 256> ones{};
  for (std::size_t bits = 0; bits < ones.size(); ++bits) ones[bits] = static_cast<std::uint8_t>(std::popcount(bits));
  return ones;
}();

}  // namespace

VoxelClusters::VoxelClusters(const VoxelMap& map, VoxelPosition position) : points_(map.voxels().size()) {
  std::size_t blocks = 0;
  std::size_t clusters = 0;
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count == 0) continue;
    ++blocks;
    for (const std::uint32_t count : voxels_in_clusters(block)) clusters += count > 0 ? 1 : 0;
  }
  blocks_.reserve(blocks);
  boxes_.reserve(clusters);
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count > 0) add_block(map, position, block);
  }
  boxes_.close(static_cast<std::uint32_t>(map.voxels().size()));
  index_rows();
}

void VoxelClusters::add_block(const VoxelMap& map, VoxelPosition position, const VoxelBlock& block) {
  const std::array<std::uint32_t, kClusters> counts = voxels_in_clusters(block);
  std::array<std::uint32_t, kClusters> next{};
  std::uint32_t before = block.first_voxel;
  for (std::size_t k = 0; k < kClusters; ++k) {
    next[k] = before;
    before += counts[k];
  }
  std::uint32_t voxel = block.first_voxel;
  for (std::size_t z = 0; z < kBlockSize; ++z) {
    std::uint32_t* const of_half = next.data() + (z < kHalf ? 0 : kClusters / 2);
    for (std::uint64_t bits = block.occupied[z]; bits != 0; bits &= bits - 1, ++voxel) {
      const std::uint32_t slot = of_half[kQuadrants[static_cast<std::size_t>(std::countr_zero(bits))]]++;
      const Eigen::Vector3f at_m = voxel_position_m(map, voxel, position).cast<float>();
      points_.x[slot] = at_m.x();
      points_.y[slot] = at_m.y();
      points_.z[slot] = at_m.z();
      points_.number[slot] = static_cast<std::int32_t>(voxel);
    }
  }
  Block added{block.key, {boxes_.size(), 0}};
  const std::array<const std::vector<float>*, 3> columns = {&points_.x, &points_.y, &points_.z};
  for (std::size_t k = 0; k < kClusters; ++k) {
    if (counts[k] == 0) continue;
    Cluster cluster;
    cluster.first = next[k] - counts[k];
    cluster.end = next[k];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Extent extent = extent_of(*columns[axis], cluster.first, cluster.end);
      cluster.low_m[axis] = extent.low_m;
      cluster.high_m[axis] = extent.high_m;
    }
    boxes_.add(cluster);
  }
  added.clusters.end = boxes_.size();
  blocks_.push_back(added);
}

void VoxelClusters::index_rows() {
  if (blocks_.empty()) return;
  Eigen::Vector3i high = block_of_key(blocks_.front().key);
  low_ = high;
  for (const Block& block : blocks_) {
    const Eigen::Vector3i at = block_of_key(block.key);
    low_ = low_.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  size_ = high - low_ + Eigen::Vector3i::Ones();
  octets_in_row_ = static_cast<std::size_t>((size_.x() + kOctet - 1) / kOctet);
  const double octets = static_cast<double>(octets_in_row_) * size_.y() * size_.z();
  const auto most = kOctetsAlways + kOctetsPerBlock * static_cast<double>(blocks_.size());
  if (octets > most || blocks_.size() >= kMostBlocks) return;
  octets_.resize(static_cast<std::size_t>(octets));
  for (const Block& block : blocks_) {
    const Eigen::Vector3i at = block_of_key(block.key) - low_;
    const std::size_t row = static_cast<std::size_t>(at.z()) * size_.y() + at.y();
    octets_[row * octets_in_row_ + at.x() / kOctet] |= Octet{1} << (at.x() % kOctet);
  }
  std::uint32_t before = 0;
  for (Octet& octet : octets_) {
    const std::uint32_t ones = kOnes[octet];
    octet |= before << kOctet;
    before += ones;
  }
}

// Of the row, and of all before it; x from the first block of the table, up to its size.
std::uint32_t VoxelClusters::blocks_before(int x, std::size_t row) const {
  const std::size_t number = row * octets_in_row_ + x / kOctet;
  if (number == octets_.size()) return static_cast<std::uint32_t>(blocks_.size());
  const Octet below = (Octet{1} << (x % kOctet)) - 1;
  return (octets_[number] >> kOctet) + kOnes[octets_[number] & below];
}

std::uint32_t VoxelClusters::blocks_before_key(std::uint64_t key) const {
  const auto found = std::lower_bound(blocks_.begin(), blocks_.end(), key,
                                      [](const Block& block, std::uint64_t other) { return block.key < other; });
  return static_cast<std::uint32_t>(found - blocks_.begin());
}

VoxelClusters::Range VoxelClusters::in_row(int x_first, int x_end, int y, int z) const {
  const int row_y = y - low_.y();
  const int row_z = z - low_.z();
  const int first_x = std::max(x_first - low_.x(), 0);
  const int end_x = std::min(x_end - low_.x(), size_.x());
  if (row_y < 0 || row_y >= size_.y() || row_z < 0 || row_z >= size_.z() || first_x >= end_x) return {};
  std::uint32_t first = 0;
  std::uint32_t end = 0;
  if (octets_.empty()) {
    first = blocks_before_key(block_key({first_x + low_.x(), y, z}));
    end = blocks_before_key(block_key({end_x - 1 + low_.x(), y, z}) + 1);
  } else {
    const std::size_t row = static_cast<std::size_t>(row_z) * size_.y() + row_y;
    first = blocks_before(first_x, row);
    end = blocks_before(end_x, row);  // where the row's last octet is full, that is the next row's beginning
  }
  if (first == end) return {};
  return {blocks_[first].clusters.first, blocks_[end - 1].clusters.end};
}

std::size_t VoxelClusters::bytes() const {
  return points_.bytes() + boxes_.bytes() + blocks_.size() * sizeof(Block) + octets_.size() * sizeof(Octet);
}

}  // namespace kilter
