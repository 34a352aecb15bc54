// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/octree_reader.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/octree_header.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

using Index = std::array<std::int16_t, 3>;

constexpr std::int16_t kLowest = std::numeric_limits<std::int16_t>::min();

// An inner node on the way down, and which of its children are still to be visited.
struct Branch {
  Index index{};
  std::uint8_t level = kOctreeLevels;  // of the node itself
  std::uint8_t pending = 0;            // bit i: child i
};

// Child i lies in the upper half of x, y, z where bits 0, 1, 2 of i are set.
Index child_index(const Index& parent, int level, unsigned child) {
  Index index = parent;
  for (unsigned axis = 0; axis < 3; ++axis) {
    index[axis] = static_cast<std::int16_t>(index[axis] + static_cast<int>((child >> axis) & 1U) * (1 << (level - 1)));
  }
  return index;
}

// The nodes between root and leaf. 16 levels, so the deepest branch is of level 1.
class Path {
 public:
  // \return false for an inner node at the lowest level.
  bool descend(const Index& index, int level, std::uint8_t children) {
    if (level == 0) return false;
    branches_[depth_++] = {index, static_cast<std::uint8_t>(level), children};
    return true;
  }

  // The next node that waits for its turn, depth first; its level, or nothing after the last.
  std::optional<int> next(Index& index) {
    while (depth_ > 0) {
      Branch& branch = branches_[depth_ - 1];
      if (branch.pending != 0) {
        const auto child = static_cast<unsigned>(std::countr_zero(branch.pending));
        branch.pending = static_cast<std::uint8_t>(branch.pending & (branch.pending - 1));
        index = child_index(branch.index, branch.level, child);
        return branch.level - 1;
      }
      --depth_;
    }
    return std::nullopt;
  }

 private:
  std::array<Branch, kOctreeLevels> branches_;
  std::size_t depth_ = 0;
};

tl::unexpected<Error> too_deep(const ByteCursor& bytes, const std::string& where) {
  return fail(ErrorCode::kParse,
              fmt::format("the tree goes deeper than its {} levels before byte {}", kOctreeLevels, bytes.position()),
              where);
}

tl::unexpected<Error> cut_short(const ByteCursor& bytes, std::uint64_t nodes, std::uint64_t promised,
                                const std::string& where) {
  return fail(
      ErrorCode::kTruncated,
      fmt::format("the bytes end at {} within the tree, after {} of {} nodes", bytes.position(), nodes, promised),
      where);
}

Expected<void> check_end(const ByteCursor& bytes, std::uint64_t nodes, const OctreeHeader& header,
                         const std::string& where) {
  if (nodes != header.nodes) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("the header promises {} nodes, the tree has {}", header.nodes,
                            nodes > header.nodes ? "more" : fmt::format("only {}", nodes)),
                where);
  }
  if (!is_padding(bytes.rest())) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("the tree of {} nodes ends at byte {}, and {} bytes more follow", nodes, bytes.position(),
                            bytes.remaining()),
                where);
  }
  return {};
}

// `.ot`: each node is its log-odds, perhaps a colour, and which children follow.
Expected<OccupancyCells> read_full(ByteCursor& bytes, const OctreeHeader& header, const std::string& where) {
  OccupancyCells known{header.resolution_m, {}};
  const std::size_t node_bytes = header.node_bytes();
  if (header.nodes > bytes.remaining() / node_bytes) {
    return fail(ErrorCode::kTruncated,
                fmt::format("the header promises {} nodes of {} bytes, but only {} bytes follow", header.nodes,
                            node_bytes, bytes.remaining()),
                where);
  }
  known.cells.reserve(header.nodes);
  Path path;
  std::uint64_t nodes = 0;
  Index index = {kLowest, kLowest, kLowest};
  std::optional<int> level;
  if (header.nodes > 0) level = kOctreeLevels;
  for (; level; level = path.next(index)) {
    const auto node = bytes.take(node_bytes);
    if (!node) return cut_short(bytes, nodes, header.nodes, where);
    if (++nodes > header.nodes) break;
    const auto log_odds = load<float>(node->data(), std::endian::little);
    if (const auto children = static_cast<std::uint8_t>(node->back()); children != 0) {
      if (!path.descend(index, *level, children)) return too_deep(bytes, where);
    } else if (std::isfinite(log_odds)) {
      known.cells.push_back({index, static_cast<std::uint8_t>(*level), log_odds});
    } else {
      return fail(
          ErrorCode::kParse,
          fmt::format("the log-odds of the leaf before byte {} is {}, not a finite number", bytes.position(), log_odds),
          where);
    }
  }
  if (auto ok = check_end(bytes, nodes, header, where); !ok) return pass_up(ok.error());
  return known;
}

// The two bits of each of eight children.
enum ChildCode : unsigned { kUnknownChild = 0, kFreeChild = 1, kOccupiedChild = 2, kInnerChild = 3 };

// Adds the leaves below one inner node. \return which children are inner nodes themselves.
std::uint8_t add_leaves(OccupancyCells& known, const Index& index, int level, unsigned codes) {
  unsigned inner = 0;
  for (unsigned child = 0; child < 8; ++child) {
    const unsigned code = codes >> (2 * child) & 3U;
    if (code == kInnerChild) inner |= 1U << child;
    if (code != kFreeChild && code != kOccupiedChild) continue;
    known.cells.push_back({child_index(index, level, child), static_cast<std::uint8_t>(level - 1),
                           code == kFreeChild ? kBinaryFreeLogOdds : kBinaryOccupiedLogOdds});
  }
  return static_cast<std::uint8_t>(inner);
}

// Children that are there: a pair of bits that is not 00.
unsigned count_children(unsigned codes) { return static_cast<unsigned>(std::popcount((codes | codes >> 1) & 0x5555U)); }

// `.bt`: only inner nodes take bytes, two each.
Expected<OccupancyCells> read_binary(ByteCursor& bytes, const OctreeHeader& header, const std::string& where) {
  OccupancyCells known{header.resolution_m, {}};
  if (header.nodes / 4 > bytes.remaining()) {
    return fail(ErrorCode::kTruncated,
                fmt::format("the header promises {} nodes, more than the {} bytes that follow can hold", header.nodes,
                            bytes.remaining()),
                where);
  }
  known.cells.reserve(header.nodes);
  Path path;
  std::uint64_t nodes = header.nodes > 0 ? 1 : 0;
  Index index = {kLowest, kLowest, kLowest};
  std::optional<int> level;
  if (header.nodes > 0) level = kOctreeLevels;
  for (; level; level = path.next(index)) {
    const auto node = bytes.take(2);
    if (!node) return cut_short(bytes, nodes, header.nodes, where);
    const auto codes = load<std::uint16_t>(node->data(), std::endian::little);
    if (*level == 0) return too_deep(bytes, where);
    if (codes == 0) {
      return fail(ErrorCode::kParse, fmt::format("the inner node before byte {} has no children", bytes.position()),
                  where);
    }
    nodes += count_children(codes);
    if (nodes > header.nodes) break;
    if (!path.descend(index, *level, add_leaves(known, index, *level, codes))) return too_deep(bytes, where);
  }
  if (auto ok = check_end(bytes, nodes, header, where); !ok) return pass_up(ok.error());
  return known;
}

}  // namespace

bool has_octree_name(std::string_view file_name) {
  const std::string name = lower_case(file_name);
  return name.size() > 3 && (name.ends_with(".ot") || name.ends_with(".bt"));
}

Expected<OccupancyCells> read_octree(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(bytes);
  const Expected<OctreeHeader> header = take_octree_header(cursor, where);
  if (!header) return pass_up(header.error());
  return header->format == OctreeFormat::kFull ? read_full(cursor, *header, where)
                                               : read_binary(cursor, *header, where);
}

Expected<OccupancyCells> read_octree_file(const std::filesystem::path& path) {
  const Expected<ByteBuffer> bytes = read_file(path);
  if (!bytes) return pass_up(bytes.error());
  return read_octree(bytes->view(), shown(path));
}

Expected<double> read_octree_resolution_m(const std::filesystem::path& path) {
  std::string start(65536, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(ErrorCode::kIo, "cannot be read", shown(path));
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  ByteCursor cursor(start);
  const Expected<OctreeHeader> header = take_octree_header(cursor, shown(path));
  if (!header) return pass_up(header.error());
  return header->resolution_m;
}

PointCloud occupied_centres(const OccupancyCells& known) {
  PointCloud cloud;
  for (const OccupancyCell& cell : known.cells) {
    if (cell.log_odds < OccupancyCells::kOccupiedFrom) continue;
    const double half = 0.5 * std::ldexp(1.0, cell.level);
    std::array<double, 3> centre_m{};
    for (std::size_t axis = 0; axis < 3; ++axis) centre_m[axis] = (cell.index[axis] + half) * known.resolution_m;
    add_point(cloud, centre_m);
  }
  return cloud;
}

}  // namespace kilter
