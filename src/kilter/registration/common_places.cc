// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/common_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kilter/base/contract.h"
#include "kilter/occupancy/key_numbers.h"

namespace kilter {
namespace {

// The cells that places are.
class Lattice {
 public:
  explicit Lattice(double edge_m) : edge_m_(edge_m) {}

  // Counts a point among those that no border should go through.
  void look_at(const Eigen::Vector3d& at_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double part = at_m[axis] / edge_m_ - std::floor(at_m[axis] / edge_m_);
      ++shown_[static_cast<std::size_t>(axis)][std::min(static_cast<std::size_t>(part * kParts), kParts - 1)];
    }
  }

  void put_borders_where_least_is() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::array<std::uint64_t, kParts>& shown = shown_[axis];
      std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
      for (std::size_t k = 0; k < kParts; ++k) {
        const std::uint64_t near = shown[(k + kParts - 1) % kParts] + 2 * shown[k] + shown[(k + 1) % kParts];
        if (near >= least) continue;
        least = near;
        border_m_[static_cast<Eigen::Index>(axis)] = (static_cast<double>(k) + 0.5) / kParts * edge_m_;
      }
    }
  }

  [[nodiscard]] std::uint64_t key_of(const Eigen::Vector3d& at_m) const {
    constexpr int kBits = 21;
    const auto on_axis = [&](int axis) {
      const auto cell = static_cast<std::int64_t>(std::floor((at_m[axis] - border_m_[axis]) / edge_m_));
      return static_cast<std::uint64_t>(cell + (std::int64_t{1} << (kBits - 1))) & ((std::uint64_t{1} << kBits) - 1);
    };
    return (on_axis(2) << kBits | on_axis(1)) << kBits | on_axis(0);
  }

 private:
  static constexpr std::size_t kParts = 12;
  double edge_m_;
  Eigen::Vector3d border_m_ = Eigen::Vector3d::Zero();
  std::array<std::array<std::uint64_t, kParts>, 3> shown_{};
};

// What one submap saw of a place.
struct Seen {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  double hits = 0.0;
  ShareOfTime times{};

  void add(const Eigen::Vector3d& at_m, std::uint8_t seen_at, double count) {
    point_m += count * at_m;
    hits += count;
    times[time_bin(seen_at)] += static_cast<float>(count);
  }
  [[nodiscard]] Eigen::Vector3d mean_m() const { return point_m / hits; }
  [[nodiscard]] ShareOfTime shares() const {
    ShareOfTime shares = times;
    for (float& share : shares) share = static_cast<float>(share / hits);
    return shares;
  }
};

// The target's come first, then what the source saw of the same.
class PlaceSums {
 public:
  explicit PlaceSums(const Lattice& lattice) : lattice_(lattice) {}

  void add_target(const Eigen::Vector3d& belongs_at_m, const Eigen::Vector3d& at_m, std::uint8_t seen_at, double hits) {
    const std::uint32_t number = numbers_.find_or_add(lattice_.key_of(belongs_at_m));
    if (number == target_.size()) target_.emplace_back();
    target_[number].add(at_m, seen_at, hits);
  }

  void add_source(const Eigen::Vector3d& belongs_at_m, const Eigen::Vector3d& at_m, std::uint8_t seen_at, double hits) {
    const std::uint32_t number = numbers_.find(lattice_.key_of(belongs_at_m));
    if (number == KeyNumbers::kNone) return;
    source_.resize(target_.size());
    source_[number].add(at_m, seen_at, hits);
  }

  // Of those that both saw, in the order in which the target's came.
  [[nodiscard]] std::vector<CommonPlace> common() const {
    std::vector<CommonPlace> places;
    for (std::size_t k = 0; k < source_.size(); ++k) {
      if (source_[k].hits == 0.0) continue;
      places.push_back({0.5 * (source_[k].mean_m() + target_[k].mean_m()), source_[k].shares(), target_[k].shares()});
    }
    return places;
  }

 private:
  Lattice lattice_;
  KeyNumbers numbers_;
  std::vector<Seen> target_;  // by number
  std::vector<Seen> source_;
};

}  // namespace

double place_edge_m(const PairGrain& grain) { return std::max(kPlace_m, 2.0 * grain.edge_m); }

std::vector<CommonPlace> places_of(std::span<const PlaneResidual> residuals, double edge_m) {
  Lattice lattice(edge_m);
  for (const PlaneResidual& r : residuals) lattice.look_at(r.point_m);
  lattice.put_borders_where_least_is();
  PlaceSums sums(lattice);
  for (const PlaneResidual& r : residuals) sums.add_target(r.point_m, r.point_m, r.target_at, 1.0);
  for (const PlaneResidual& r : residuals) sums.add_source(r.point_m, r.point_m, r.source_at, 1.0);
  return sums.common();
}

std::vector<CommonPlace> common_places(const VoxelMap& source, const VoxelMap& target, const Pose3& T_target_source,
                                       const MotionsInTime& motions, double edge_m) {
  const SurfaceVoxels& of_target = target.voxels();
  const SurfaceVoxels& of_source = source.voxels();
  KILTER_EXPECTS(of_target.hits.size() == of_target.size() && of_source.hits.size() == of_source.size());
  Lattice lattice(edge_m);
  for (const Eigen::Vector3f& at_m : of_target.centroids_m) lattice.look_at(at_m.cast<double>());
  lattice.put_borders_where_least_is();
  PlaceSums sums(lattice);
  for (std::size_t i = 0; i < of_target.size(); ++i) {
    const Eigen::Vector3d at_m = of_target.centroids_m[i].cast<double>();
    const std::uint8_t seen_at = of_target.seen_at[i];
    sums.add_target(at_m + motions.target[time_bin(seen_at)].of(at_m), at_m, seen_at, of_target.hits[i]);
  }
  const Eigen::Isometry3d T = T_target_source.isometry();
  for (std::size_t i = 0; i < of_source.size(); ++i) {
    const Eigen::Vector3d at_m = T * of_source.centroids_m[i].cast<double>();
    const std::uint8_t seen_at = of_source.seen_at[i];
    sums.add_source(at_m + motions.source[time_bin(seen_at)].of(at_m), at_m, seen_at, of_source.hits[i]);
  }
  return sums.common();
}

PlaceMoments moments_of(std::span<const CommonPlace> places) {
  PlaceMoments moments;
  moments.count = places.size();
  const auto count = static_cast<double>(places.size());
  for (const CommonPlace& place : places) moments.mean_m += place.point_m / count;
  for (const CommonPlace& place : places) {
    const Eigen::Vector3d arm_m = place.point_m - moments.mean_m;
    moments.scatter_m2.noalias() += arm_m * arm_m.transpose() / count;
  }
  return moments;
}

}  // namespace kilter
