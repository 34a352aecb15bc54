// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

// Distances that blocks beside the home block are looked at up to, as shares of a block's edge: most answers lie within
// a voxel.
constexpr std::array kRings = {0.125, 0.375};

}  // namespace

NearestVoxelSearch::NearestVoxelSearch(const VoxelMap& map, VoxelPosition position, double max_distance_m,
                                       VectorPath path)
    : map_(&map),
      position_(position),
      max_distance_m_(max_distance_m),
      path_(path),
      clusters_(map, position),
      scan_(scan_clusters_with(path)) {
  KILTER_EXPECTS(max_distance_m > 0.0);
  plan_steps();
}

// Shells of blocks that are equally far from the home block. The innermost, which touches it, is looked at ring by
// ring.
void NearestVoxelSearch::plan_steps() {
  const double edge_m = kBlockSize * map_->resolution_m();
  const int reach = static_cast<int>(std::ceil(max_distance_m_ / edge_m));
  struct Shell {
    double gap_m2 = 0.0;
    Run run;
  };
  std::vector<Shell> shells;
  const auto gap_m2 = [&](int x, int y, int z) {
    const Eigen::Array3i between = Eigen::Array3i(x, y, z).abs() - 1;
    return (between.max(0).cast<double>() * edge_m).matrix().squaredNorm();
  };
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double here_m2 = gap_m2(x, y, z);
        if (here_m2 > max_distance_m_ * max_distance_m_) continue;
        const bool goes_on = x > -reach && !shells.empty() && shells.back().run.x_end == x &&
                             shells.back().run.y == y && shells.back().gap_m2 == here_m2;
        if (goes_on) {
          ++shells.back().run.x_end;
        } else {
          shells.push_back({here_m2, {x, x + 1, y, z}});
        }
      }
    }
  }
  std::stable_sort(shells.begin(), shells.end(), [](const Shell& a, const Shell& b) { return a.gap_m2 < b.gap_m2; });
  for (const Shell& shell : shells) runs_.push_back(shell.run);
  for (std::size_t first = 0; first < shells.size();) {
    const double least_m2 = shells[first].gap_m2;
    std::size_t end = first;
    while (end < shells.size() && shells[end].gap_m2 == least_m2) ++end;
    Step step;
    step.first = static_cast<std::uint32_t>(first);
    step.end = static_cast<std::uint32_t>(end);
    step.least_m2 = kRoundedDown * static_cast<float>(least_m2);
    for (const double ring : kRings) {
      if (first > 0) break;
      step.to_m2 = static_cast<float>(ring * edge_m * ring * edge_m);
      steps_.push_back(step);
      step.first = step.end;
      step.from_m2 = step.to_m2;
      step.to_m2 = std::numeric_limits<float>::max();
      step.least_m2 = kRoundedDown * step.from_m2;
    }
    steps_.push_back(step);
    first = end;
  }
}

std::optional<NearestVoxel> NearestVoxelSearch::nearest(const Eigen::Vector3d& point_m, double limit_m) const {
  return NearestVoxelCursor(*this).nearest(point_m, limit_m);
}

const NearestVoxelField* NearestVoxelSearch::field() const {
  std::call_once(field_->asked, [&] {
    if (!NearestVoxelField::fits(*map_, max_distance_m_)) return;
    field_->field = std::make_unique<const NearestVoxelField>(*map_, max_distance_m_, path_);
    field_->made.store(field_->field.get(), std::memory_order_release);
  });
  return field_->field.get();
}

std::size_t NearestVoxelSearch::bytes() const {
  const NearestVoxelField* field = field_->made.load(std::memory_order_acquire);
  return clusters_.bytes() + runs_.size() * sizeof(Run) + steps_.size() * sizeof(Step) +
         (field == nullptr ? 0 : field->bytes());
}

NearestVoxelCursor::NearestVoxelCursor(const NearestVoxelSearch& search) : search_(&search) {}

NearestVoxelCursor::Home& NearestVoxelCursor::home_at(const Eigen::Vector3i& block) {
  const std::uint32_t number = numbers_.find_or_add(block_key(block));
  if (number < homes_.size()) return homes_[number];
  if (homes_.size() == kMostHomes || groups_ > kMostGroups) {
    homes_.clear();
    groups_ = 0;
    numbers_ = {};
    numbers_.find_or_add(block_key(block));
  }
  return homes_.emplace_back(Home{block, {}, {}, 0});
}

bool NearestVoxelCursor::extend(Home& home, float best_m2) const {
  if (home.steps == search_->steps_.size() || search_->steps_[home.steps].least_m2 > best_m2) return false;
  const NearestVoxelSearch::Step& step = search_->steps_[home.steps++];
  const ClusterBoxes& boxes = search_->clusters_.boxes();
  const double edge_m = kBlockSize * search_->map_->resolution_m();
  FloatBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int at = home.at[static_cast<Eigen::Index>(axis)];
    box.low_m[axis] = static_cast<float>(at * edge_m);
    box.high_m[axis] = static_cast<float>((at + 1) * edge_m);
  }
  ClusterGroup group(step.least_m2);
  const auto add = [&](const Cluster& cluster) {
    group.add(cluster);
    if (!group.full()) return;
    home.groups.push_back(group);
    group = ClusterGroup(step.least_m2);
  };
  for (const Farther& left : home.farther) {
    if (left.gap_m2 >= step.from_m2 && left.gap_m2 < step.to_m2) add(boxes[left.cluster]);
  }
  for (std::uint32_t k = step.first; k < step.end; ++k) {
    const NearestVoxelSearch::Run& run = search_->runs_[k];
    const VoxelClusters::Range range = search_->clusters_.in_row(home.at.x() + run.x_first, home.at.x() + run.x_end,
                                                                 home.at.y() + run.y, home.at.z() + run.z);
    for (std::uint32_t i = range.first; i < range.end; ++i) {
      const Cluster cluster = boxes[i];
      const float gap_m2 = box.square_gap_m2(cluster);
      if (gap_m2 < step.to_m2) {
        add(cluster);
      } else {
        home.farther.push_back({i, gap_m2});
      }
    }
  }
  if (step.to_m2 == std::numeric_limits<float>::max()) home.farther = {};
  if (!group.empty()) home.groups.push_back(group);
  return true;
}

std::optional<NearestVoxel> NearestVoxelCursor::nearest(const Eigen::Vector3d& point_m, double limit_m,
                                                        std::uint32_t hint) {
  KILTER_EXPECTS(limit_m <= search_->max_distance_m_ * (1.0 + 1e-12));
  const VoxelMap& map = *search_->map_;
  // Half of a pair's points lie where the other has nothing at all. A voxel's points are within it, whichever stands.
  const double reach_m = limit_m + map.resolution_m();
  if (map.bounds_m().squaredExteriorDistance(point_m) > reach_m * reach_m) return std::nullopt;
  Home& home = home_at(block_of(voxel_at(point_m, map.resolution_m())));
  const Eigen::Vector3f point = point_m.cast<float>();
  // A little slack so that rounding to float never hides a voxel at exactly the limit; checked in double below.
  NearestPoint best{static_cast<float>(limit_m * limit_m * 1.0001 + 1e-12), ClusteredPoints::kNoNumber};
  if (hint == kNoVoxel) hint = last_voxel_;
  if (hint != kNoVoxel) {
    const Eigen::Vector3f off_m = voxel_position_m(map, hint, search_->position_).cast<float>() - point;
    const float square_m2 = off_m.x() * off_m.x() + off_m.y() * off_m.y() + off_m.z() * off_m.z();
    if (square_m2 <= best.square_m2) best = {square_m2, static_cast<std::int32_t>(hint)};
  }
  std::size_t looked_at = 0;
  groups_ -= home.groups.size();
  do {
    search_->scan_(search_->clusters_.points(), std::span(home.groups).subspan(looked_at), point.data(), best);
    looked_at = home.groups.size();
  } while (extend(home, best.square_m2));
  groups_ += home.groups.size();
  if (best.number == ClusteredPoints::kNoNumber) return std::nullopt;
  last_voxel_ = static_cast<std::uint32_t>(best.number);
  const double distance_m = (voxel_position_m(map, last_voxel_, search_->position_) - point_m).norm();
  if (distance_m > limit_m) return std::nullopt;
  return NearestVoxel{last_voxel_, distance_m};
}

RepeatedSearch::RepeatedSearch(const NearestVoxelSearch& search, std::size_t points)
    : field_(search.field()), cursor_(search) {
  KILTER_EXPECTS(search.position() == VoxelPosition::kCentroid);
  if (exact()) last_.assign(points, kNoVoxel);
}

void RepeatedSearch::near(std::span<const std::uint32_t> points, const PointColumns& at_m, double limit_m,
                          Found& found) {
  KILTER_EXPECTS(limit_m <= search().max_distance_m() * (1.0 + 1e-12));
  KILTER_EXPECTS(points.size() <= PointColumns::kMost);
  if (!exact()) {
    look_up(at_m, points.size(), limit_m, found);
    return;
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::uint32_t& last = last_[points[k]];
    const std::optional<NearestVoxel> nearest = cursor_.nearest(at_m[k], limit_m, last);
    if (nearest) last = nearest->voxel;
    found.voxel[k] = nearest ? nearest->voxel : kNoVoxel;
    if (nearest) found.at_m.set(k, search().map().voxels().centroids_m[last]);
    found.square_m2[k] = nearest ? nearest->distance_m * nearest->distance_m : 0.0;
  }
}

void RepeatedSearch::look_up(const PointColumns& at_m, std::size_t count, double limit_m, Found& found) const {
  const VoxelMap& map = search().map();
  const LookUpKernels& kernels = look_up_kernels(search().path());
  field_->near(at_m, count, found.voxel);
  kernels.take_rows(map.voxels().centroids_m.data(), found.voxel, count, found.at_m);
  kernels.measure(at_m, found.at_m, count, found.square_m2);
  for (std::size_t k = 0; k < count; ++k) {
    found.voxel[k] = found.square_m2[k] > limit_m * limit_m ? kNoVoxel : found.voxel[k];
  }
}

}  // namespace kilter
