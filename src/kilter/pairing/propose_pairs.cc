// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pairing/propose_pairs.h"

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <optional>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

namespace bg = boost::geometry;
using Point = bg::model::point<double, 3, bg::cs::cartesian>;
using Box = bg::model::box<Point>;
using Entry = std::pair<Box, int>;

Box widened(const Eigen::AlignedBox3d& box, double by_m) {
  return {{box.min().x() - by_m, box.min().y() - by_m, box.min().z() - by_m},
          {box.max().x() + by_m, box.max().y() + by_m, box.max().z() + by_m}};
}

// The kind of (source, target), or nothing where the seed defines no pair.
std::optional<PairKind> kind_of(const SubmapNode& source, const SubmapNode& target, int local_min_gap) {
  if (source.robot != target.robot) return PairKind::kGlobal;
  const int gap = source.index - target.index;
  if (gap == 1) return PairKind::kSequential;
  if (gap >= local_min_gap) return PairKind::kLocal;
  return std::nullopt;
}

}  // namespace

std::vector<OptionField> fields(PairingOptions& o) {
  return {
      count_option("local_min_gap", o.local_min_gap, 2, 1000000,
                   "Submaps of one robot this many apart or more form local pairs.", "k"),
      real_option("drift_per_metre", o.drift_per_metre, Unit::kPerMetre, 0.0, 1.0,
                  "How far a pose may have drifted for each metre travelled; widens the search for pairs."),
      real_option("drift_max", o.drift_max_m, Unit::kMetre, 0.0, 1000.0,
                  "Upper end of the drift that the search for pairs allows for."),
  };
}

double drift_allowance_m(const SubmapNode& source, const SubmapNode& target, const PairingOptions& options) {
  const double path_m = source.robot == target.robot ? std::abs(source.path_end_m - target.path_start_m)
                                                     : source.path_end_m + target.path_end_m;
  return std::min(options.drift_per_metre * path_m, options.drift_max_m);
}

std::vector<CandidatePair> meeting_pairs(std::span<const SubmapNode> nodes, std::span<const CoarseMap> maps,
                                         const PairingOptions& options) {
  std::vector<Eigen::AlignedBox3d> boxes;
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    boxes.push_back(moved_box(maps[i].bounds_m(), nodes[i].T_world_submap));
    if (!boxes.back().isEmpty()) entries.emplace_back(widened(boxes.back(), 0.0), nodes[i].id.value);
  }
  const bg::index::rtree<Entry, bg::index::rstar<16>> tree(entries.begin(), entries.end());
  std::vector<CandidatePair> pairs;
  std::vector<Entry> found;
  for (const SubmapNode& source : nodes) {
    found.clear();
    const auto& box = boxes[static_cast<std::size_t>(source.id.value)];
    if (!box.isEmpty()) {
      // The widest allowance this submap can have with any other; the exact one is checked below.
      const double reach_m = options.max_distance_m + options.drift_max_m;
      tree.query(bg::index::intersects(widened(box, reach_m)), std::back_inserter(found));
    }
    for (const Entry& entry : found) {
      const SubmapNode& target = nodes[static_cast<std::size_t>(entry.second)];
      if (target.id >= source.id) continue;
      const std::optional<PairKind> kind = kind_of(source, target, options.local_min_gap);
      if (!kind || *kind == PairKind::kSequential) continue;
      const double allowance_m = drift_allowance_m(source, target, options);
      if (!bg::intersects(widened(box, options.max_distance_m + allowance_m), entry.first)) continue;
      pairs.push_back({{source.id, target.id}, *kind, allowance_m});
    }
    const bool has_predecessor = source.id.value > 0 && source.index > 0;
    if (has_predecessor) {
      const SubmapNode& target = nodes[static_cast<std::size_t>(source.id.value - 1)];
      pairs.push_back({{source.id, target.id}, PairKind::kSequential, drift_allowance_m(source, target, options)});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return pairs;
}

std::vector<CandidatePair> propose_pairs(std::span<const SubmapNode> nodes, std::span<const CoarseMap> maps,
                                         const PairingOptions& options, const RunContext& run) {
  KILTER_EXPECTS(nodes.size() == maps.size());
  std::vector<CandidatePair> pairs = meeting_pairs(nodes, maps, options);
  const auto enough = [&](const CoarseOverlap& o) {
    return o.overlap >= options.overlap_min && o.matched >= options.matched_min;
  };
  parallel_for(pairs.size(), run, [&](std::size_t i) {
    CandidatePair& pair = pairs[i];
    const auto source = static_cast<std::size_t>(pair.id.source.value);
    const auto target = static_cast<std::size_t>(pair.id.target.value);
    const Pose3 T_target_source = nodes[target].T_world_submap.inverse() * nodes[source].T_world_submap;
    const auto up_in = [&](std::size_t submap) -> Eigen::Vector3d {
      return nodes[submap].T_world_submap.rotation().conjugate() * Eigen::Vector3d::UnitZ();
    };
    const CoarseOverlap forward =
        best_coarse_overlap(maps[source], maps[target], T_target_source, pair.drift_allowance_m, up_in(target));
    // The other way round too: which of the two comes first must not decide whether a pair is looked at.
    const CoarseOverlap backward = best_coarse_overlap(maps[target], maps[source], T_target_source.inverse(),
                                                       pair.drift_allowance_m, up_in(source));
    const bool back = backward.overlap > forward.overlap;
    pair.predicted_overlap = back ? backward.overlap : forward.overlap;
    // To move the target one way in the source's frame is to move the source the other way.
    pair.predicted_shift_m = back ? Eigen::Vector3d(-(T_target_source.rotation() * backward.shift_m)) : forward.shift_m;
    pair.predicted_enough = enough(forward) || enough(backward);
  });
  return pairs;
}

}  // namespace kilter
