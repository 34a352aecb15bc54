// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/voxel_map_bytes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace kilter {
namespace {

struct Header {
  std::uint64_t checksum = 0;  // of everything behind it
  double resolution_m = 0.0;
  double cell_m = 0.0;
  std::uint64_t has_free_space = 0;
  std::uint64_t blocks = 0;
  std::uint64_t voxels = 0;
};

static_assert(std::is_trivially_copyable_v<VoxelBlock>);
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));

// Eight bytes a step; the last ones filled up with zeros.
std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  std::uint64_t sum = bytes.size();
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min(sizeof(word), bytes.size() - at));
    sum = (sum ^ word) * 0x9E3779B97F4A7C15ULL;
    sum ^= sum >> 32;
  }
  return sum;
}

std::span<const std::byte> behind_checksum(std::span<const std::byte> bytes) {
  return bytes.subspan(sizeof(Header::checksum));
}

// Every column of a map with its length, in the order of the bytes.
template <typename Blocks, typename Voxels, typename Visit>
void visit_columns(Blocks& blocks, Voxels& voxels, const Visit& visit) {
  visit(blocks.data(), blocks.size());
  visit(voxels.centroids_m.data(), voxels.centroids_m.size());
  visit(voxels.normals.data(), voxels.normals.size());
  visit(voxels.planarity.data(), voxels.planarity.size());
  visit(voxels.log_odds.data(), voxels.log_odds.size());
  visit(voxels.seen_at.data(), voxels.seen_at.size());
  visit(voxels.hits.data(), voxels.hits.size());
}

template <typename Blocks, typename Voxels>
std::size_t size_of_columns(Blocks& blocks, Voxels& voxels) {
  std::size_t size = 0;
  visit_columns(blocks, voxels, [&](const auto* column, std::size_t count) { size += count * sizeof(*column); });
  return size;
}

}  // namespace

std::vector<std::byte> bytes_of_map(const VoxelMap& map) {
  const std::span<const VoxelBlock> blocks = map.blocks();
  const SurfaceVoxels& voxels = map.voxels();
  std::vector<std::byte> bytes(sizeof(Header) + size_of_columns(blocks, voxels));
  std::byte* at = bytes.data() + sizeof(Header);
  visit_columns(blocks, voxels, [&](const auto* column, std::size_t count) {
    if (count > 0) std::memcpy(at, static_cast<const void*>(column), count * sizeof(*column));
    at += count * sizeof(*column);
  });
  Header header{0, map.resolution_m(), map.cell_m(), map.has_free_space(), blocks.size(), voxels.size()};
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.checksum = checksum_of(behind_checksum(bytes));
  std::memcpy(bytes.data(), &header.checksum, sizeof(header.checksum));
  return bytes;
}

std::optional<VoxelMap> map_of_bytes(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof(header));
  // With the checksum right, the counts are those that were written.
  if (checksum_of(behind_checksum(bytes)) != header.checksum) return std::nullopt;
  std::vector<VoxelBlock> blocks(header.blocks);
  SurfaceVoxels voxels;
  voxels.centroids_m.resize(header.voxels);
  voxels.normals.resize(header.voxels);
  voxels.planarity.resize(header.voxels);
  voxels.log_odds.resize(header.voxels);
  voxels.seen_at.resize(header.voxels);
  voxels.hits.resize(header.voxels);
  voxels.cell_m = header.cell_m;
  if (size_of_columns(blocks, voxels) != bytes.size() - sizeof(header)) return std::nullopt;
  const std::byte* at = bytes.data() + sizeof(header);
  visit_columns(blocks, voxels, [&](auto* column, std::size_t count) {
    if (count > 0) std::memcpy(static_cast<void*>(column), at, count * sizeof(*column));
    at += count * sizeof(*column);
  });
  return VoxelMap(header.resolution_m, header.has_free_space != 0, std::move(blocks), std::move(voxels));
}

}  // namespace kilter
