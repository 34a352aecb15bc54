// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/source_kind.h"

#include <algorithm>
#include <array>

#include "kilter/io/sources/foreign_file.h"
#include "kilter/io/sources/octree_file.h"
#include "kilter/io/sources/robot_folder.h"

namespace kilter {

std::span<const SourceKind> source_kinds() {
  // What interface.md promises comes first; what guesses most comes last.
  static constexpr std::array kKinds = {
      SourceKind{"robot folder", is_robot_folder, open_robot_folder},
      SourceKind{"OctoMap tree", is_octree_file, open_octree_file},
      SourceKind{"file of another kind", is_foreign_file, refuse_foreign_file},
  };
  return kKinds;
}

const SourceKind* recognise(const std::filesystem::path& path) {
  const std::span<const SourceKind> kinds = source_kinds();
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const SourceKind& kind) { return kind.matches(path); });
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace kilter
