// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes named .ot are refused with a printable reason, or are a tree that its bytes justify and that can be
// written.
#include "octree_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kilter_fuzz::demand_whole_tree(kilter_fuzz::text_of(data, size), kilter::OctreeFormat::kFull);
  return 0;
}
