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
// Those who ask together are of one cluster, unless it is nearly empty.
constexpr std::uint32_t kEnoughTogether = 10;
// Blocks of one row ask together while their voxels are few: what lies around them is looked up once.
constexpr std::uint64_t kMostInRow = 6;
constexpr std::uint32_t kFew = 256;

constexpr FloatBox kNoBox = {{ClusteredPoints::kNowhere, ClusteredPoints::kNowhere, ClusteredPoints::kNowhere},
                             {-ClusteredPoints::kNowhere, -ClusteredPoints::kNowhere, -ClusteredPoints::kNowhere}};

}  // namespace

// Asks for the voxels of a few blocks of the source after the other.
class BlocksAsking {
 public:
  BlocksAsking(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& T_target_source,
               double limit_m, VectorPath path)
      : source_(source),
        target_(target),
        T_(T_target_source.isometry()),
        limit_m_(limit_m),
        // A little slack so that rounding to float never hides a voxel at exactly the limit; checked in double below.
        limit_m2_(static_cast<float>(limit_m * limit_m * 1.0001 + 1e-12)),
        scan_(scan_for_many_with(path)) {}

  // Takes the voxels of a block, and of those behind it in its row while they are few. \return the next block.
  std::size_t ask(std::size_t block, std::vector<NearestVoxel>& found) {
    NearestVoxelSearch::ClusterRange clusters = source_.of_block_[block];
    const std::span<const VoxelBlock> blocks = source_.map_->blocks();
    const std::uint64_t last = blocks[block].key + kMostInRow;
    std::uint32_t voxels = blocks[block].voxel_count;
    for (++block; block < blocks.size() && blocks[block].key <= last; ++block) {
      voxels += blocks[block].voxel_count;
      if (voxels > kFew) break;
      clusters.end = source_.of_block_[block].end;
    }
    if (clusters.first == clusters.end) return block;
    gather(clusters);
    collect();
    for (AskingPoints& asking : asking_) scan_(target_.points_, groups_, asking);
    answer(source_.clusters_[clusters.first].first, found);
    return block;
  }

 private:
  // Blocks beside each other along one axis and the square gap of each.
  struct Line {
    int first = 0;
    std::vector<float> gaps_m2;
  };

  void gather(const NearestVoxelSearch::ClusterRange& clusters);
  void add(std::uint32_t slot);
  void line_up(std::size_t axis, float reach_m, Line& line) const;
  void collect();
  void add_clusters(std::size_t block);
  void answer(std::uint32_t slot, std::vector<NearestVoxel>& found) const;

  const NearestVoxelSearch& source_;
  const NearestVoxelSearch& target_;
  Eigen::Isometry3d T_;
  double limit_m_;
  float limit_m2_;
  ScanForMany scan_;
  std::vector<Eigen::Vector3d> at_m_;  // of those who ask, in the target's frame, by slot
  std::vector<AskingPoints> asking_;
  FloatBox box_;  // around them all
  std::array<Line, 3> lines_;
  std::vector<ClusterGroup> groups_;  // of the target, that may be near anyone
};

void BlocksAsking::gather(const NearestVoxelSearch::ClusterRange& clusters) {
  at_m_.clear();
  asking_.clear();
  box_ = kNoBox;
  for (std::uint32_t k = clusters.first; k < clusters.end; ++k) {
    const Cluster& cluster = source_.clusters_[k];
    if (asking_.empty() || asking_.back().count >= kEnoughTogether) asking_.emplace_back();
    for (std::uint32_t slot = cluster.first; slot < cluster.end; ++slot) {
      if (asking_.back().count == kMostLanes) asking_.emplace_back();
      add(slot);
    }
  }
  for (AskingPoints& asking : asking_) {
    const std::uint32_t last = asking.count - 1;
    for (std::uint32_t lane = asking.count; lane < kMostLanes; ++lane) {
      asking.x[lane] = asking.x[last];
      asking.y[lane] = asking.y[last];
      asking.z[lane] = asking.z[last];
    }
    const auto bound = [](const AskingPoints::Floats& lanes, float& low, float& high) {
      low = *std::min_element(lanes.begin(), lanes.end());
      high = *std::max_element(lanes.begin(), lanes.end());
    };
    bound(asking.x, asking.box.low_m[0], asking.box.high_m[0]);
    bound(asking.y, asking.box.low_m[1], asking.box.high_m[1]);
    bound(asking.z, asking.box.low_m[2], asking.box.high_m[2]);
    asking.square_m2.fill(limit_m2_);
    asking.farthest_m2 = limit_m2_;
    asking.number.fill(ClusteredPoints::kNoNumber);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box_.low_m[axis] = std::min(box_.low_m[axis], asking.box.low_m[axis]);
      box_.high_m[axis] = std::max(box_.high_m[axis], asking.box.high_m[axis]);
    }
  }
}

void BlocksAsking::add(std::uint32_t slot) {
  const auto voxel = static_cast<std::size_t>(source_.points_.number[slot]);
  const Eigen::Vector3d at_m = T_ * voxel_position_m(*source_.map_, voxel, source_.position_);
  const Eigen::Vector3f point_m = at_m.cast<float>();
  at_m_.push_back(at_m);
  AskingPoints& asking = asking_.back();
  asking.x[asking.count] = point_m.x();
  asking.y[asking.count] = point_m.y();
  asking.z[asking.count] = point_m.z();
  ++asking.count;
}

// How far the target's blocks of each row, column or layer lie from the box of those who ask.
void BlocksAsking::line_up(std::size_t axis, float reach_m, Line& line) const {
  const double edge_m = kBlockSize * target_.map_->resolution_m();
  const double low_m = box_.low_m[axis];
  const double high_m = box_.high_m[axis];
  line.first = static_cast<int>(std::floor((low_m - reach_m) / edge_m));
  const int end = static_cast<int>(std::floor((high_m + reach_m) / edge_m)) + 1;
  line.gaps_m2.clear();
  for (int k = line.first; k < end; ++k) {
    const double gap_m = std::max({k * edge_m - high_m, low_m - (k + 1) * edge_m, 0.0});
    line.gaps_m2.push_back(static_cast<float>(gap_m * gap_m));
  }
}

// The target's clusters that may hold something within the limit for anyone.
void BlocksAsking::collect() {
  groups_.clear();
  const auto reach_m = static_cast<float>(limit_m_ + kSlackVoxels * target_.map_->resolution_m());
  const float reach_m2 = reach_m * reach_m;
  for (std::size_t axis = 0; axis < 3; ++axis) line_up(axis, reach_m, lines_[axis]);
  const auto& [columns, rows, layers] = lines_;
  for (std::size_t z = 0; z < layers.gaps_m2.size(); ++z) {
    for (std::size_t y = 0; y < rows.gaps_m2.size(); ++y) {
      const float gap_m2 = layers.gaps_m2[z] + rows.gaps_m2[y];
      if (gap_m2 > reach_m2) continue;
      for (std::size_t x = 0; x < columns.gaps_m2.size(); ++x) {
        if (gap_m2 + columns.gaps_m2[x] > reach_m2) continue;
        const std::int32_t number =
            target_.map_->find_block({columns.first + static_cast<int>(x), rows.first + static_cast<int>(y),
                                      layers.first + static_cast<int>(z)});
        if (number != BlockIndex::kNone) add_clusters(static_cast<std::size_t>(number));
      }
    }
  }
}

void BlocksAsking::add_clusters(std::size_t block) {
  const NearestVoxelSearch::ClusterRange range = target_.of_block_[block];
  for (std::uint32_t i = range.first; i < range.end; ++i) {
    const Cluster& cluster = target_.clusters_[i];
    if (kRoundedDown * box_.square_gap_m2(cluster) > limit_m2_) continue;
    if (groups_.empty() || groups_.back().full()) groups_.emplace_back(0.0F);
    groups_.back().add(cluster);
  }
}

void BlocksAsking::answer(std::uint32_t slot, std::vector<NearestVoxel>& found) const {
  std::size_t k = 0;
  for (const AskingPoints& asking : asking_) {
    for (std::uint32_t lane = 0; lane < asking.count; ++lane, ++k, ++slot) {
      if (asking.number[lane] == ClusteredPoints::kNoNumber) continue;
      const auto voxel = static_cast<std::uint32_t>(asking.number[lane]);
      const double distance_m = (voxel_position_m(*target_.map_, voxel, target_.position_) - at_m_[k]).norm();
      if (distance_m > limit_m_) continue;
      found[static_cast<std::size_t>(source_.points_.number[slot])] = {voxel, distance_m};
    }
  }
}

std::vector<NearestVoxel> nearest_of_all(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                         const Pose3& T_target_source, double limit_m, VectorPath path) {
  KILTER_EXPECTS(limit_m <= target.max_distance_m() * (1.0 + 1e-12));
  KILTER_EXPECTS(source.position() == target.position());
  std::vector<NearestVoxel> found(source.map().voxels().size(), NearestVoxel{kNoVoxel, 0.0});
  if (target.map().voxels().size() == 0) return found;
  BlocksAsking asking(source, target, T_target_source, limit_m, path);
  for (std::size_t block = 0; block < source.map().blocks().size();) block = asking.ask(block, found);
  return found;
}

NearestBothWays nearest_both_ways(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                  const Pose3& T_target_source, double limit_m) {
  return {nearest_of_all(source, target, T_target_source, limit_m),
          nearest_of_all(target, source, T_target_source.inverse(), limit_m)};
}

}  // namespace kilter
