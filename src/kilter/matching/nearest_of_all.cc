// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_of_all.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kilter/base/contract.h"
#include "kilter/matching/scan_for_many.h"

namespace kilter {
namespace {

// A centroid lies in its voxel, but for the rounding of its floats.
constexpr double kSlackVoxels = 0.01;
// Of a coordinate, more than its floats round away; it counts some kilometres from the origin.
constexpr double kRoundedAway = 1e-6;
// Those who ask together are of one cluster, unless it is nearly empty.
constexpr std::uint32_t kEnoughTogether = 10;
// Blocks of one row ask together while their voxels are few: what lies around them is looked up once.
constexpr std::uint64_t kMostInRow = 6;
constexpr std::uint32_t kFew = 256;
// How far what is looked at together lies from those who ask, as shares of a block's edge: most answers are near.
constexpr std::array kRings = {0.375F, 0.75F};
constexpr float kNothing_m2 = -1.0F;  // no gap is as small

}  // namespace

// Asks for the voxels of a few blocks of the source after the other.
class BlocksAsking {
 public:
  BlocksAsking(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& T_target_source,
               double limit_m, VectorPath path)
      : source_(source),
        from_(source.clusters()),
        target_(target),
        onto_(target.clusters()),
        T_(T_target_source.isometry()),
        limit_m_(limit_m),
        // A little slack so that rounding to float never hides a voxel at exactly the limit; checked in double below.
        limit_m2_(static_cast<float>(limit_m * limit_m * 1.0001 + 1e-12)),
        kernels_(many_search_kernels(path)) {
    for (const float share : kRings) {
      const float m = share * kBlockSize * static_cast<float>(target.map().resolution_m());
      if (m * m < limit_m2_) rings_.push_back({m * m, {}});
    }
    rings_.push_back({limit_m2_, {}});
  }

  // Takes the voxels of a block, and of those behind it in its row while they are few. \return the next block.
  std::size_t ask(std::size_t block, std::vector<NearestVoxel>& found) {
    const std::span<const VoxelClusters::Block> blocks = from_.blocks();
    VoxelClusters::Range clusters = blocks[block].clusters;
    const std::uint64_t last = blocks[block].key + kMostInRow;
    const std::vector<std::uint32_t>& first_of = from_.boxes().first;
    for (++block; block < blocks.size() && blocks[block].key <= last; ++block) {
      if (first_of[blocks[block].clusters.end] - first_of[clusters.first] > kFew) break;
      clusters.end = blocks[block].clusters.end;
    }
    bound(clusters);
    find_rows();
    bool any = false;
    for (std::size_t k = 0; k < rings_.size() && !any && !rows_.empty(); ++k) any = !ring(k).empty();
    if (any) {
      answer_all(clusters, found);
    } else {
      std::fill(found.begin() + first_of[clusters.first], found.begin() + first_of[clusters.end],
                NearestVoxel{kNoVoxel, 0.0});
    }
    return block;
  }

 private:
  // Clusters of the target in a row of blocks.
  struct Row {
    VoxelClusters::Range clusters;
    float gap_m2 = 0.0F;  // at least, from the box of those who ask
  };
  // Clusters of the target, as far from the box of those who ask as the ring before does not reach.
  struct Ring {
    float reach_m2 = 0.0F;
    std::vector<ClusterGroup> groups;
  };

  void bound(const VoxelClusters::Range& clusters);
  void find_rows();
  const std::vector<ClusterGroup>& ring(std::size_t k);
  void answer_all(const VoxelClusters::Range& clusters, std::vector<NearestVoxel>& found);
  void gather(std::uint32_t first, std::uint32_t count, const std::vector<NearestVoxel>& found);
  void answer(std::uint32_t first, std::vector<NearestVoxel>& found) const;

  const NearestVoxelSearch& source_;
  const VoxelClusters& from_;
  const NearestVoxelSearch& target_;
  const VoxelClusters& onto_;
  Eigen::Isometry3d T_;
  double limit_m_;
  float limit_m2_;
  ManySearchKernels kernels_;
  FloatBox box_;           // around all who may ask, in the target's frame
  std::vector<Row> rows_;  // that may hold something within the limit
  std::vector<Ring> rings_;
  std::size_t known_ = 0;  // of the rings
  AskingPoints asking_;
};

// Around the corners of the clusters' boxes.
void BlocksAsking::bound(const VoxelClusters::Range& clusters) {
  const double slack_m = kSlackVoxels * target_.map().resolution_m();
  const Eigen::Matrix3d turned = T_.linear().cwiseAbs();
  Eigen::AlignedBox3d box_m;
  for (std::uint32_t k = clusters.first; k < clusters.end; ++k) {
    const Cluster cluster = from_.boxes()[k];
    const Eigen::Vector3d low_m = Eigen::Map<const Eigen::Vector3f>(cluster.low_m.data()).cast<double>();
    const Eigen::Vector3d high_m = Eigen::Map<const Eigen::Vector3f>(cluster.high_m.data()).cast<double>();
    const Eigen::Vector3d middle_m = T_ * Eigen::Vector3d(0.5 * (low_m + high_m));
    const Eigen::Vector3d rounded_m = kRoundedAway * middle_m.cwiseAbs() + Eigen::Vector3d::Constant(slack_m);
    const Eigen::Vector3d half_m = turned * (0.5 * (high_m - low_m)) + rounded_m;
    box_m.extend(middle_m - half_m).extend(middle_m + half_m);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box_.low_m[axis] = static_cast<float>(box_m.min()[static_cast<Eigen::Index>(axis)]);
    box_.high_m[axis] = static_cast<float>(box_m.max()[static_cast<Eigen::Index>(axis)]);
  }
}

void BlocksAsking::find_rows() {
  rows_.clear();
  known_ = 0;
  const double edge_m = kBlockSize * target_.map().resolution_m();
  const double reach_m = limit_m_ + kSlackVoxels * target_.map().resolution_m();
  std::array<int, 3> first{};
  std::array<int, 3> last{};
  const Eigen::AlignedBox3d& target_m = target_.map().bounds_m();  // far from which there are too many rows to ask
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    const double low_m = std::max(box_.low_m[axis] - reach_m, target_m.min()[k] - edge_m);
    const double high_m = std::min(box_.high_m[axis] + reach_m, target_m.max()[k] + edge_m);
    if (low_m > high_m) return;
    first[axis] = whole_below(low_m / edge_m);
    last[axis] = whole_below(high_m / edge_m);
  }
  const auto gap_m = [&](std::size_t axis, int k) {
    return std::max({k * edge_m - box_.high_m[axis], box_.low_m[axis] - (k + 1) * edge_m, 0.0});
  };
  for (int z = first[2]; z <= last[2]; ++z) {
    const double layer_m = gap_m(2, z);
    for (int y = first[1]; y <= last[1]; ++y) {
      const double row_m = gap_m(1, y);
      const double gap_m2 = layer_m * layer_m + row_m * row_m;
      if (gap_m2 > reach_m * reach_m) continue;
      const VoxelClusters::Range clusters = onto_.in_row(first[0], last[0] + 1, y, z);
      if (clusters.first < clusters.end) rows_.push_back({clusters, kRoundedDown * static_cast<float>(gap_m2)});
    }
  }
}

// Most need nothing of the later ones.
const std::vector<ClusterGroup>& BlocksAsking::ring(std::size_t k) {
  for (; known_ <= k; ++known_) {
    Ring& ring = rings_[known_];
    ring.groups.clear();
    const float above_m2 = known_ == 0 ? kNothing_m2 : rings_[known_ - 1].reach_m2;
    for (const Row& row : rows_) {
      if (row.gap_m2 > ring.reach_m2) continue;
      kernels_.pick(onto_.boxes(), row.clusters.first, row.clusters.end, box_, above_m2, ring.reach_m2, ring.groups);
    }
  }
  return rings_[k].groups;
}

// Those who ask together are of one cluster, unless it is nearly empty.
void BlocksAsking::answer_all(const VoxelClusters::Range& clusters, std::vector<NearestVoxel>& found) {
  const std::vector<std::uint32_t>& first_of = from_.boxes().first;
  const std::uint32_t end = first_of[clusters.end];
  std::uint32_t k = clusters.first;
  for (std::uint32_t first = first_of[k]; first < end;) {
    while (first_of[k + 1] - first < kEnoughTogether && k + 1 < clusters.end) ++k;
    const std::uint32_t count = std::min(first_of[k + 1] - first, kMostLanes);
    gather(first, count, found);
    float reached_m2 = kNothing_m2;
    for (std::size_t ring_number = 0; ring_number < rings_.size() && asking_.farthest_m2 > reached_m2; ++ring_number) {
      const std::vector<ClusterGroup>& groups = ring(ring_number);
      if (!groups.empty()) kernels_.scan(onto_.points(), groups, asking_);
      reached_m2 = rings_[ring_number].reach_m2;
    }
    answer(first, found);
    first += count;
    if (first == first_of[k + 1]) ++k;
  }
}

void BlocksAsking::gather(std::uint32_t first, std::uint32_t count, const std::vector<NearestVoxel>& found) {
  const ClusteredPoints& points = from_.points();
  const std::array<const float*, 3> columns = {points.x.data() + first, points.y.data() + first,
                                               points.z.data() + first};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t lane = 0; lane < kMostLanes; ++lane) asking_.at_m[axis][lane] = columns[axis][lane];
  }
  if (source_.position() == VoxelPosition::kCentre) {  // whose floats are rounded
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      const Eigen::Vector3d at_m = voxel_position_m(source_.map(), first + lane, VoxelPosition::kCentre);
      for (std::size_t axis = 0; axis < 3; ++axis) asking_.at_m[axis][lane] = at_m[static_cast<Eigen::Index>(axis)];
    }
  }
  for (AskingPoints::Doubles& axis : asking_.at_m) std::fill(axis.begin() + count, axis.end(), axis[count - 1]);
  kernels_.move(T_, asking_);
  asking_.count = count;
  asking_.farthest_m2 = limit_m2_;
  asking_.square_m2.fill(limit_m2_);
  asking_.number.fill(ClusteredPoints::kNoNumber);
  bool any = false;
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    const std::uint32_t voxel = found[first + lane].voxel;
    if (voxel == kNoVoxel) continue;
    asking_.number[lane] = static_cast<std::int32_t>(voxel);
    any = true;
  }
  std::fill(asking_.number.begin() + count, asking_.number.end(), asking_.number[count - 1]);
  if (any) kernels_.begin(onto_.points(), asking_);
}

void BlocksAsking::answer(std::uint32_t first, std::vector<NearestVoxel>& found) const {
  for (std::uint32_t lane = 0; lane < asking_.count; ++lane) {
    NearestVoxel& own = found[first + lane];
    own = {kNoVoxel, 0.0};
    if (asking_.number[lane] == ClusteredPoints::kNoNumber) continue;
    const auto voxel = static_cast<std::uint32_t>(asking_.number[lane]);
    const Eigen::Vector3d at_m(asking_.at_m[0][lane], asking_.at_m[1][lane], asking_.at_m[2][lane]);
    const double distance_m = (voxel_position_m(target_.map(), voxel, target_.position()) - at_m).norm();
    if (distance_m <= limit_m_) own = {voxel, distance_m};
  }
}

void nearest_of_all_again(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                          const Pose3& T_target_source, double limit_m, std::vector<NearestVoxel>& found,
                          VectorPath path) {
  KILTER_EXPECTS(limit_m <= target.max_distance_m() * (1.0 + 1e-12));
  KILTER_EXPECTS(source.position() == target.position());
  KILTER_EXPECTS(found.size() == source.map().voxels().size());
  if (target.map().voxels().size() == 0) {
    std::fill(found.begin(), found.end(), NearestVoxel{kNoVoxel, 0.0});
    return;
  }
  BlocksAsking asking(source, target, T_target_source, limit_m, path);
  for (std::size_t block = 0; block < source.clusters().blocks().size();) block = asking.ask(block, found);
}

std::vector<NearestVoxel> nearest_of_all(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                         const Pose3& T_target_source, double limit_m, VectorPath path) {
  std::vector<NearestVoxel> found(source.map().voxels().size(), NearestVoxel{kNoVoxel, 0.0});
  nearest_of_all_again(source, target, T_target_source, limit_m, found, path);
  return found;
}

NearestBothWays nearest_both_ways(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                  const Pose3& T_target_source, double limit_m) {
  return {nearest_of_all(source, target, T_target_source, limit_m),
          // NOLINTNEXTLINE(readability-suspicious-call-argument): the way back
          nearest_of_all(target, source, T_target_source.inverse(), limit_m)};
}

}  // namespace kilter
