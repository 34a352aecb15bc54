// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/register_clouds.h"

#include <utility>
#include <vector>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

Submap submap_of(const PointCloud& cloud, bool scan, int number, const Pose3& T_world_submap,
                 const OccupancyOptions& options) {
  std::vector<Eigen::Vector3d> points_m;
  points_m.reserve(cloud.points_m.size());
  for (const Eigen::Vector3f& point_m : cloud.points_m) points_m.push_back(point_m.cast<double>());
  MapBuilder builder(options);
  if (scan) {
    builder.insert_scan(points_m, Eigen::Vector3d::Zero());
  } else {
    builder.insert_points(points_m);
  }
  Submap submap;
  submap.id = {number};
  submap.robot = number;
  submap.name = number == 0 ? "target" : "source";
  submap.T_world_submap = T_world_submap;
  submap.map = builder.finish();
  return submap;
}

}  // namespace

Expected<PairMeasurement> register_clouds(const CloudPair& clouds, const CheckOptions& options, const RunContext& run) {
  CheckOptions own = resolved(options);
  own.matching.overlap_min = 0.0;
  own.registration.always_search = true;  // one pair can afford it, and a start is often a guess
  std::vector<Submap> submaps;
  submaps.push_back(submap_of(clouds.target, clouds.scans, 0, {}, own.submap.occupancy));
  submaps.push_back(submap_of(clouds.source, clouds.scans, 1, clouds.T_target_source_init, own.submap.occupancy));
  for (const Submap& submap : submaps) {
    if (submap.map.voxels().size() == 0) {
      return fail(ErrorCode::kInvalidArgument, "the " + submap.name + " cloud leaves no voxel within the range limits",
                  {}, "see min_range and max_range in kilter config show");
    }
  }
  const SubmapSearches searches = build_searches(submaps, own, run);
  CandidatePair pair;
  pair.id = {submaps[1].id, submaps[0].id};
  pair.kind = PairKind::kGlobal;
  pair.predicted_enough = true;
  PairMeasurement measurement = measure_pair(submaps, searches, pair, own);
  std::optional<RegistrationResult>& registration = measurement.evidence.registration;
  if (!registration) registration.emplace().T_target_source = clouds.T_target_source_init;  // nothing to align
  return measurement;
}

}  // namespace kilter
