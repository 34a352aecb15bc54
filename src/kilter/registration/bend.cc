// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "kilter/registration/bend_in_time.h"
#include "kilter/registration/plane_matches.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr std::size_t kFewestOfPart = 300;
constexpr double kLeastHalf_m = 3.0;  // standard deviation along the longest axis that is worth a cut
constexpr int kMostCuts = 3;          // one after the other: eight parts
constexpr double kShrink = 0.6;       // of the kernel, from one step to the next
constexpr int kLastSteps = 3;         // at the final kernel
constexpr double kLeastGain = 1.3;  // of the residuals that vanish, among those that a motion changes, for it to count
constexpr std::size_t kFewestGained = 20;
// How far the RMS over a dozen parts is from that over all places, as a share of it: one standard deviation, seen where
// the truth is known.
constexpr double kScatter = 0.25;

// Once the motions are known, a place has its like within this much; what is farther only one of the two saw. [voxels]
constexpr double kRematchVoxels = 3.0;

using Residuals = std::vector<PlaneResidual>;

struct Spread {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double deviation_m = 0.0;
};

Spread longest_axis(std::span<const PlaneResidual> residuals) {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  for (const PlaneResidual& r : residuals) centre_m += r.point_m / static_cast<double>(residuals.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_about(residuals, centre_m));
  return {solver.eigenvectors().col(2), std::sqrt(std::max(solver.eigenvalues()[2], 0.0))};
}

using Parts = std::vector<std::span<const PlaneResidual>>;

// Rearranges the residuals so that each part is one stretch of them.
void cut_in_space(std::span<PlaneResidual> residuals, int cuts, Parts& parts) {
  if (cuts < kMostCuts && residuals.size() >= 2 * kFewestOfPart) {
    const Spread spread = longest_axis(residuals);
    if (spread.deviation_m >= kLeastHalf_m) {
      const auto half = residuals.size() / 2;
      std::nth_element(residuals.begin(), residuals.begin() + static_cast<std::ptrdiff_t>(half), residuals.end(),
                       [&](const PlaneResidual& a, const PlaneResidual& b) {
                         return spread.axis.dot(a.point_m) < spread.axis.dot(b.point_m);
                       });
      cut_in_space(residuals.first(half), cuts + 1, parts);
      cut_in_space(residuals.subspan(half), cuts + 1, parts);
      return;
    }
  }
  if (residuals.size() >= kFewestOfPart) parts.emplace_back(residuals);
}

// The residuals after the motion, to first order, weighted by a Geman-McClure kernel.
Residuals moved(std::span<const PlaneResidual> part, const Eigen::Vector3d& centre_m, const Vector6& motion,
                double scale_m) {
  Residuals after(part.begin(), part.end());
  for (PlaneResidual& r : after) {
    r.residual_m += r.direction.dot(motion.head<3>() + motion.tail<3>().cross(r.point_m - centre_m));
    r.weight *= geman_mcclure(r.residual_m, scale_m);
  }
  return after;
}

// How far a motion is to be believed, 0 to 1: of the residuals that it makes vanish, the share by which they outnumber
// those that it brings up. Only what the motion changes is asked: most of a scene may be floor, which fits at every
// shift and says nothing; and clutter fits as well elsewhere.
double belief_in_motion(std::span<const PlaneResidual> before, std::span<const PlaneResidual> after, double vanish_m) {
  std::size_t vanished = 0;
  std::size_t appeared = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::abs(after[i].residual_m - before[i].residual_m) < vanish_m) continue;
    vanished += std::abs(after[i].residual_m) < vanish_m ? 1 : 0;
    appeared += std::abs(before[i].residual_m) < vanish_m ? 1 : 0;
  }
  if (vanished < appeared + kFewestGained ||
      static_cast<double>(vanished) < kLeastGain * static_cast<double>(appeared)) {
    return 0.0;
  }
  return 1.0 - static_cast<double>(appeared) / static_cast<double>(vanished);
}

struct PartMotion {
  double mean_m2 = 0.0;
  double variance_m4 = 0.0;
};

PartMotion motion_of(std::span<const PlaneResidual> part, const PairGrain& grain, double reach_m) {
  const double resolution_m = grain.edge_m;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  for (const PlaneResidual& r : part) centre_m += r.point_m / static_cast<double>(part.size());
  Vector6 motion = Vector6::Zero();
  int last_steps = 0;
  for (double scale_m = 0.5 * reach_m; last_steps < kLastSteps; scale_m = std::max(scale_m * kShrink, resolution_m)) {
    last_steps += scale_m <= resolution_m ? 1 : 0;
    const Residuals now = moved(part, centre_m, motion, scale_m);
    const NormalEquations equations = build_normal_equations(now);
    const Vector6 step = solve_observable(equations, split_observable(equations, now));
    // The step is about the weighted centre; moved to the part's own.
    motion.head<3>() += step.head<3>() + step.tail<3>().cross(centre_m - equations.centre_m);
    motion.tail<3>() += step.tail<3>();
  }
  const Residuals before = moved(part, centre_m, Vector6::Zero(), resolution_m);
  const Residuals after = moved(part, centre_m, motion, resolution_m);
  const double belief = belief_in_motion(before, after, support_m(grain));
  const Residuals& settled = belief > 0.0 ? after : before;
  const NormalEquations equations = build_normal_equations(settled);
  const ObservableSplit split = split_observable(equations, settled);
  const Matrix6 about_weighted =
      patch_covariance(settled, equations, split, kPatch_m, kPlanePatchVoxels * resolution_m) +
      cell_covariance(settled, equations, split, grain.variance_m2);
  Matrix6 to_centre = Matrix6::Identity();
  to_centre.topRightCorner<3, 3>() = -skew(centre_m - equations.centre_m);
  const Matrix6 covariance = to_centre * about_weighted * to_centre.transpose();
  const Matrix6 M = displacement_form(Eigen::Vector3d::Zero(), scatter_about(part, centre_m));
  const Matrix6 MC = M * covariance;
  if (belief == 0.0) motion.setZero();
  const double mean_m2 = motion.dot(M * motion) - (belief > 0.0 ? MC.trace() : 0.0);
  // Either it moved or it did not.
  return {belief * mean_m2,
          2.0 * (MC * MC).trace() + 4.0 * motion.dot(MC * (M * motion)) + belief * (1.0 - belief) * mean_m2 * mean_m2};
}

Bend bend_by_place(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m) {
  Residuals sorted(residuals.begin(), residuals.end());
  Parts parts;
  cut_in_space(sorted, 0, parts);
  double total = 0.0;
  for (const std::span<const PlaneResidual> part : parts) total += static_cast<double>(part.size());
  Bend bend;
  bend.parts = static_cast<int>(parts.size());
  bend.places = moments_of(places_of(residuals, place_edge_m(grain)));
  double mean_m2 = 0.0;
  for (const std::span<const PlaneResidual> part : parts) {
    const double share = static_cast<double>(part.size()) / total;
    const PartMotion motion = motion_of(part, grain, reach_m);
    mean_m2 += share * motion.mean_m2;
    bend.variance_m4 += share * share * motion.variance_m4;
  }
  bend.rms_m = std::sqrt(std::max(mean_m2, 0.0));
  const double scatter_m2 = 2.0 * kScatter * bend.rms_m * bend.rms_m;
  bend.variance_m4 += scatter_m2 * scatter_m2;
  return bend;
}

}  // namespace

Bend measure_bend(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m,
                  const PairInMotion& in_motion) {
  const TimesKnown known = times_known(residuals);
  if (known.source && known.target) return bend_in_time(residuals, grain, reach_m, in_motion);
  Bend bend = bend_by_place(residuals, grain, reach_m);
  if (!known.source && !known.target) return bend;
  const Bend in_time = bend_in_time(residuals, grain, reach_m, in_motion);
  if (in_time.rms_m > bend.rms_m) return in_time;
  bend.places = in_time.places;
  return bend;
}

Bend measure_bend(PlanePair& pair, const Pose3& T_target_source, double reach_m,
                  std::span<const PlaneResidual> residuals) {
  const double near_m = std::min(reach_m, kRematchVoxels * pair.grain.edge_m);
  PairInMotion in_motion;
  in_motion.rematch = [&](const MotionOfPlace& shift) {
    return match_planes(pair, T_target_source, near_m, kBendPoints, shift);
  };
  in_motion.find_places = [&](const MotionsInTime& motions) {
    return common_places(pair.source_map(), pair.target_map(), T_target_source, motions, place_edge_m(pair.grain));
  };
  return measure_bend(residuals, pair.grain, reach_m, in_motion);
}

}  // namespace kilter
