// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/source_kind.h"

#include <algorithm>
#include <array>

#include "kilter/io/bags/bag_source.h"
#include "kilter/io/sources/flat_folder.h"
#include "kilter/io/sources/foreign_file.h"
#include "kilter/io/sources/glim_dump.h"
#include "kilter/io/sources/hdl_dump.h"
#include "kilter/io/sources/kiss_slam.h"
#include "kilter/io/sources/kitti_sequence.h"
#include "kilter/io/sources/lt_mapper.h"
#include "kilter/io/sources/octree_file.h"
#include "kilter/io/sources/robot_folder.h"
#include "kilter/io/sources/single_cloud.h"

namespace kilter {

std::span<const SourceKind> source_kinds() {
  // What interface.md promises comes first; what guesses most comes last.
  static constexpr std::array kKinds = {
      SourceKind{"robot folder", is_robot_folder, open_robot_folder},
      SourceKind{"GLIM dump", is_glim_dump, open_glim_dump},
      SourceKind{"hdl_graph_slam dump", is_hdl_dump, open_hdl_dump},
      SourceKind{"KISS-SLAM result", is_kiss_slam_result, open_kiss_slam_result},
      SourceKind{"LT-mapper session", is_lt_mapper_session, open_lt_mapper_session},
      SourceKind{"KITTI sequence", is_kitti_sequence, open_kitti_sequence},
      SourceKind{"folder of clouds", is_flat_folder, open_flat_folder},
      SourceKind{"single cloud", is_single_cloud, open_single_cloud},
      SourceKind{"OctoMap tree", is_octree_file, open_octree_file},
      SourceKind{"ROS 1 bag", is_rosbag1, open_rosbag1_source, true},
      SourceKind{"ROS 2 bag (MCAP)", is_mcap_bag, open_mcap_source, true},
      SourceKind{"ROS 2 bag (sqlite3)", is_sqlite_bag, open_sqlite_source, true},
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
