// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/registration/peers.h"

#ifdef KILTER_HAS_PCL
#include "benchmarks/registration/peers_pcl.h"
#endif
#ifdef KILTER_HAS_OPEN3D
#include "benchmarks/registration/peers_open3d.h"
#endif

namespace kilter {
namespace {

using Align = std::optional<Pose3> (*)(const VoxelMap&, const VoxelMap&, const Pose3&);

struct Peer {
  std::string name;
  Align align;
};

std::vector<Peer> peers() {
  return {
#ifdef KILTER_HAS_PCL
      {"pcl-icp", align_by_pcl_icp},           {"pcl-plane", align_by_pcl_plane},
      {"pcl-gicp", align_by_pcl_gicp},         {"pcl-ndt", align_by_pcl_ndt},
#endif
#ifdef KILTER_HAS_OPEN3D
      {"open3d-plane", align_by_open3d_plane}, {"open3d-gicp", align_by_open3d_gicp},
#endif
  };
}

}  // namespace

std::vector<std::string> peer_names() {
  std::vector<std::string> names;
  for (const Peer& peer : peers()) names.push_back(peer.name);
  return names;
}

std::optional<Pose3> align_by_peer(const std::string& name, const VoxelMap& source, const VoxelMap& target,
                                   const Pose3& T_target_source_start) {
  for (const Peer& peer : peers()) {
    if (peer.name == name) return peer.align(source, target, T_target_source_start);
  }
  return std::nullopt;
}

}  // namespace kilter
