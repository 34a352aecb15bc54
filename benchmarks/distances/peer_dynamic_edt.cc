// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <dynamicEDT3D/dynamicEDTOctomap.h>

#include <memory>

#include "methods.h"

namespace kilter {
namespace {

struct State {
  octomap::OcTree tree;
  std::unique_ptr<DynamicEDTOctomap> field;

  explicit State(const Side& side) : tree(side.map.resolution_m()) {
    for (const Eigen::Vector3f& point_m : side.points_m) {
      tree.updateNode(octomap::point3d(point_m.x(), point_m.y(), point_m.z()), true, true);
    }
    tree.updateInnerOccupancy();
    const Eigen::Vector3f low_m = (side.map.bounds_m().min().array() - kLimit_m).matrix().cast<float>();
    const Eigen::Vector3f high_m = (side.map.bounds_m().max().array() + kLimit_m).matrix().cast<float>();
    field = std::make_unique<DynamicEDTOctomap>(static_cast<float>(kLimit_m), &tree,
                                                octomap::point3d(low_m.x(), low_m.y(), low_m.z()),
                                                octomap::point3d(high_m.x(), high_m.y(), high_m.z()), false);
    field->update();
  }
};

float distance_of(State& state, const Eigen::Vector3f& at_m) {
  const float found_m = state.field->getDistance(octomap::point3d(at_m.x(), at_m.y(), at_m.z()));
  return found_m < 0.0F || found_m >= static_cast<float>(kLimit_m) ? kNone : found_m;  // -1 is outside
}

}  // namespace

Method by_dynamic_edt(const Side& source, const Side& target) {
  return point_by_point<State>("dynamicEDT3D", source, target, distance_of);
}

}  // namespace kilter
