// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/octree_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <span>
#include <tuple>
#include <vector>

namespace kilter {
namespace {

// A leaf by its way from the root: three bits a level, the root's child on top.
struct Leaf {
  std::uint64_t path = 0;
  std::uint8_t level = 0;
  float log_odds = 0.0F;
};

// Bits of x, y, z next to each other, x lowest: at each level the number of a child.
std::uint64_t path_of(const std::array<std::int16_t, 3>& index) {
  std::uint64_t path = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto key = static_cast<std::uint64_t>(index[axis] + 32768);
    for (unsigned bit = 0; bit < 16; ++bit) path |= (key >> bit & 1U) << (3 * bit + axis);
  }
  return path;
}

unsigned child_of(const Leaf& leaf, int level) { return static_cast<unsigned>(leaf.path >> (3 * (level - 1)) & 7U); }

bool is_occupied(const Leaf& leaf) { return leaf.log_odds >= OccupancyCells::kOccupiedFrom; }

// Whether the last eight leaves are one cube's children and say the same.
bool can_merge(const std::vector<Leaf>& leaves) {
  if (leaves.size() < 8) return false;
  const std::span<const Leaf> last(leaves.end() - 8, leaves.end());
  const Leaf& first = last.front();
  if (first.level >= kOctreeLevels || child_of(first, first.level + 1) != 0) return false;
  for (unsigned child = 0; child < 8; ++child) {
    const std::uint64_t path = first.path | static_cast<std::uint64_t>(child) << (3 * first.level);
    const Leaf& leaf = last[child];
    if (leaf.level != first.level || leaf.path != path || leaf.log_odds != first.log_odds) return false;
  }
  return true;
}

// Sorted depth first, without overlaps, as large as they can be.
std::vector<Leaf> pruned_leaves(const OccupancyCells& known, OctreeFormat format) {
  std::vector<Leaf> sorted;
  sorted.reserve(known.cells.size());
  for (const OccupancyCell& cell : known.cells) {
    Leaf leaf{path_of(cell.index), cell.level, cell.log_odds};
    if (format == OctreeFormat::kBinary) leaf.log_odds = is_occupied(leaf) ? 1.0F : -1.0F;
    sorted.push_back(leaf);
  }
  std::sort(sorted.begin(), sorted.end(), [](const Leaf& a, const Leaf& b) {
    return std::tuple(a.path, -a.level, -a.log_odds) < std::tuple(b.path, -b.level, -b.log_odds);
  });
  std::vector<Leaf> leaves;
  std::uint64_t covered = 0;  // paths below this one are taken
  for (const Leaf& leaf : sorted) {
    if (leaf.path < covered) continue;
    covered = leaf.path + (std::uint64_t{1} << (3 * leaf.level));
    leaves.push_back(leaf);
    while (can_merge(leaves)) {
      leaves.resize(leaves.size() - 7);
      ++leaves.back().level;
    }
  }
  return leaves;
}

// Writes nodes depth first. Goes down at most 16 levels, one for each of a node's children.
class TreeWriter {
 public:
  explicit TreeWriter(OctreeFormat format) : format_(format) {}

  void write(std::span<const Leaf> leaves) {
    if (leaves.empty()) return;
    ++nodes_;
    node(leaves, kOctreeLevels);
  }

  [[nodiscard]] std::uint64_t nodes() const { return nodes_; }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  using Children = std::array<std::span<const Leaf>, 8>;

  static bool is_leaf(std::span<const Leaf> leaves, int level) { return leaves.front().level == level; }

  static Children split(std::span<const Leaf> leaves, int level) {
    Children children;
    for (unsigned child = 0; child < 8; ++child) {
      const auto end = std::partition_point(leaves.begin(), leaves.end(),
                                            [&](const Leaf& leaf) { return child_of(leaf, level) <= child; });
      const auto count = static_cast<std::size_t>(end - leaves.begin());
      children[child] = leaves.first(count);
      leaves = leaves.subspan(count);
    }
    return children;
  }

  void node(std::span<const Leaf> leaves, int level) {
    const bool leaf = is_leaf(leaves, level);
    const Children children = leaf ? Children{} : split(leaves, level);
    if (format_ == OctreeFormat::kFull) {
      put_full(leaves, children);
    } else {
      put_binary(children, level);
    }
    for (const std::span<const Leaf>& child : children) {
      if (child.empty()) continue;
      ++nodes_;
      if (format_ == OctreeFormat::kFull || !is_leaf(child, level - 1)) node(child, level - 1);
    }
  }

  void put_full(std::span<const Leaf> leaves, const Children& children) {
    const auto most = std::max_element(leaves.begin(), leaves.end(),
                                       [](const Leaf& a, const Leaf& b) { return a.log_odds < b.log_odds; });
    const auto word = std::bit_cast<std::uint32_t>(most->log_odds);
    for (unsigned shift = 0; shift < 32; shift += 8) bytes_ += static_cast<char>(word >> shift & 0xFFU);
    unsigned mask = 0;
    for (unsigned child = 0; child < 8; ++child) mask |= (children[child].empty() ? 0U : 1U) << child;
    bytes_ += static_cast<char>(mask);
  }

  // 01 free, 10 occupied, 11 with children of its own; the first child's bits are the lowest.
  void put_binary(const Children& children, int level) {
    unsigned codes = 0;
    for (unsigned child = 0; child < 8; ++child) {
      if (children[child].empty()) continue;
      const bool inner = !is_leaf(children[child], level - 1);
      codes |= (inner ? 3U : is_occupied(children[child].front()) ? 2U : 1U) << (2 * child);
    }
    bytes_ += static_cast<char>(codes & 0xFFU);
    bytes_ += static_cast<char>(codes >> 8);
  }

  OctreeFormat format_;
  std::string bytes_;
  std::uint64_t nodes_ = 0;
};

}  // namespace

std::string octree_bytes(const OccupancyCells& known, OctreeFormat format) {
  std::vector<Leaf> leaves = pruned_leaves(known, format);
  // A `.bt` has no way to say that the root itself is a leaf.
  if (format == OctreeFormat::kBinary && leaves.size() == 1 && leaves.front().level == kOctreeLevels) {
    leaves.front().level = kOctreeLevels - 1;
    leaves.resize(8, leaves.front());
    for (std::uint64_t child = 0; child < 8; ++child) leaves[child].path = child << (3 * (kOctreeLevels - 1));
  }
  TreeWriter tree(format);
  tree.write(leaves);
  return fmt::format("{}\n# written by kilter\nid OcTree\nsize {}\nres {}\ndata\n",
                     format == OctreeFormat::kFull ? kFullOctreeLine : kBinaryOctreeLine, tree.nodes(),
                     known.resolution_m) +
         tree.bytes();
}

}  // namespace kilter
