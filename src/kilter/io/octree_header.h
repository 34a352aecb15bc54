// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/octree_format.h"

namespace kilter {

/// The lines before the tree.
struct OctreeHeader {
  OctreeFormat format = OctreeFormat::kFull;
  double resolution_m = 0.1;     ///< edge of the smallest cell; 0.1 mm to 1 km. [m]
  std::uint64_t nodes = 0;       ///< inner ones and leaves, as promised
  std::size_t colour_bytes = 0;  ///< of each node of a ColorOcTree, behind its log-odds; kFull only

  /// Bytes of one node. kFull only.
  [[nodiscard]] std::size_t node_bytes() const { return sizeof(float) + colour_bytes + 1; }
};

/// Takes the header up to and with its line `data`.
///
/// Unknown keywords are passed over, as OctoMap does. Whether the promised nodes can be there is not looked at.
/// \return  the header, or kParse (no tree at all, a missing or senseless line), kUnsupported (another class of tree,
///          the headerless files of OctoMap before 1.0), kTruncated (it ends before `data`).
[[nodiscard]] Expected<OctreeHeader> take_octree_header(ByteCursor& bytes, const std::string& where);

}  // namespace kilter
