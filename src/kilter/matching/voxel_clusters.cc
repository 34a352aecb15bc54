// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/voxel_clusters.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kilter/matching/registers.h"

namespace kilter {
namespace {

constexpr std::uint32_t kMostTogether = kMostLanes;  // voxels of a cluster

std::uint32_t clusters_in(const VoxelBlock& block) { return (block.voxel_count + kMostTogether - 1) / kMostTogether; }

using Floats = Register<4>::Floats;
using Ints = Register<4>::Ints;
constexpr std::uint32_t kLanes = 4;

Floats four_at(const float* column_m) {
  Floats four;
  std::memcpy(&four, column_m, sizeof(four));
  return four;
}

// The smallest of the lanes of each.
Floats least_of(const Floats& a, const Floats& b, const Floats& c, const Floats& d) {
  const auto smaller = [](const Floats& one, const Floats& other) { return one < other ? one : other; };
  const Floats ab = smaller(__builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7));
  const Floats cd = smaller(__builtin_shufflevector(c, d, 0, 1, 4, 5), __builtin_shufflevector(c, d, 2, 3, 6, 7));
  return smaller(__builtin_shufflevector(ab, cd, 0, 2, 4, 6), __builtin_shufflevector(ab, cd, 1, 3, 5, 7));
}

// Points [first, end), at least one, and the box around them. Of fewer than four the others of a register repeat one.
Cluster cluster_of(const ClusteredPoints& points, std::uint32_t first, std::uint32_t end) {
  constexpr std::array<Ints, kLanes + 1> kBelow = {Ints{}, Ints{-1, 0, 0, 0}, Ints{-1, -1, 0, 0}, Ints{-1, -1, -1, 0},
                                                   Ints{-1, -1, -1, -1}};
  const Ints meant = kBelow[std::min(end - first, kLanes)];
  const std::array<const float*, 3> columns_m = {points.x.data(), points.y.data(), points.z.data()};
  std::array<Floats, 3> low{};
  std::array<Floats, 3> high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats lanes = four_at(columns_m[axis] + first);
    low[axis] = high[axis] = meant != 0 ? lanes : Floats{} + lanes[0];
  }
  for (std::uint32_t i = first + kLanes; i < end; i += kLanes) {
    const std::uint32_t from = std::min(i, end - kLanes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Floats lanes = four_at(columns_m[axis] + from);
      low[axis] = lanes < low[axis] ? lanes : low[axis];
      high[axis] = lanes > high[axis] ? lanes : high[axis];
    }
  }
  const Floats lows = least_of(low[0], low[1], low[2], low[2]);
  const Floats highs = -least_of(-high[0], -high[1], -high[2], -high[2]);
  return {{lows[0], lows[1], lows[2]}, {highs[0], highs[1], highs[2]}, first, end};
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
    blocks += block.voxel_count > 0 ? 1 : 0;
    clusters += clusters_in(block);
  }
  blocks_.reserve(blocks);
  boxes_ = ClusterBoxes(clusters, static_cast<std::uint32_t>(map.voxels().size()));
  add_points(map, position);
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count > 0) add_block(block);
  }
  index_rows();
}

void VoxelClusters::add_points(const VoxelMap& map, VoxelPosition position) {
  for (std::size_t i = 0; i < map.voxels().size(); ++i) {
    const Eigen::Vector3f at_m = voxel_position_m(map, i, position).cast<float>();
    points_.x[i] = at_m.x();
    points_.y[i] = at_m.y();
    points_.z[i] = at_m.z();
  }
}

// All its clusters have about as many voxels.
void VoxelClusters::add_block(const VoxelBlock& block) {
  Block added{block.key, {boxes_.size(), 0}};
  const std::uint32_t clusters = clusters_in(block);
  const auto begin_of = [&](std::uint32_t k) { return block.first_voxel + block.voxel_count * k / clusters; };
  for (std::uint32_t k = 0; k < clusters; ++k) boxes_.add(cluster_of(points_, begin_of(k), begin_of(k + 1)));
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
