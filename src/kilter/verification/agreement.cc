// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/agreement.h"

#include <algorithm>
#include <cmath>

namespace kilter {
namespace {

constexpr double kSlack_m = 0.1;  // what a submap may be bent by
constexpr double kSigmas = 2.0;
constexpr double kInformative_m = 0.5;  // allowances below it always tell something
constexpr double kInformativeShare = 0.5;
constexpr int kSupported = 2;

double way_m(const Correction& a, const Correction& b) {
  return std::abs(a.source_path_m - b.source_path_m) + std::abs(a.target_path_m - b.target_path_m);
}

// Whether both corrections close over a common stretch of way. Of one robot, a pair before a slip and one across it do
// not: what one asks for is no reason to doubt the other.
bool close_over_same_way(const Correction& a, const Correction& b) {
  if (a.source_robot != a.target_robot) return true;
  const auto [a_from_m, a_to_m] = std::minmax(a.target_path_m, a.source_path_m);
  const auto [b_from_m, b_to_m] = std::minmax(b.target_path_m, b.source_path_m);
  return std::min(a_to_m, b_to_m) > std::max(a_from_m, b_from_m);
}

bool comparable(const Correction& a, const Correction& b, const AgreementOptions& options) {
  return a.source_robot == b.source_robot && a.target_robot == b.target_robot && !(a.id == b.id) &&
         way_m(a, b) <= options.neighbourhood_m;
}

enum class Say { kNothing, kSame, kOther };

Say compare(const Correction& a, const Correction& b, const AgreementOptions& options) {
  const Eigen::Vector3d to_a_m = a.T_world_correction * a.centre_world_m;
  const Eigen::Vector3d to_b_m = b.T_world_correction * a.centre_world_m;
  const Eigen::Vector3d shift_a_m = to_a_m - a.centre_world_m;
  const Eigen::Vector3d shift_b_m = b.T_world_correction * b.centre_world_m - b.centre_world_m;
  const double lever_m = (a.centre_world_m - b.centre_world_m).norm();
  const double turn_m = b.sigma_rad * lever_m;
  const double sigma_m = std::sqrt(a.sigma_m * a.sigma_m + b.sigma_m * b.sigma_m + turn_m * turn_m);
  const double allowance_m = kSlack_m + kSigmas * sigma_m + options.drift_per_metre * way_m(a, b);
  const double asked_m = std::max(shift_a_m.norm(), shift_b_m.norm());
  if (allowance_m > std::max(kInformative_m, kInformativeShare * asked_m)) return Say::kNothing;
  // Carried over as one rigid motion, or as the same shift: where each submap is tilted in its own way, as odometry
  // without a tilt sensor leaves them, the turn of one says nothing about the other.
  const double apart_m = std::min((to_a_m - to_b_m).norm(), (shift_a_m - shift_b_m).norm());
  return apart_m <= allowance_m ? Say::kSame : Say::kOther;
}

}  // namespace

std::vector<Agreement> compare_corrections(std::span<const Correction> corrections, const AgreementOptions& options) {
  std::vector<Agreement> agreements(corrections.size());
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& own = corrections[i];
    Agreement& agreement = agreements[i];
    double nearest_m = options.neighbourhood_m;
    for (const Correction& other : corrections) {
      if (!comparable(own, other, options)) continue;
      const Say say = compare(own, other, options);
      if (say == Say::kOther && close_over_same_way(own, other)) {
        ++agreement.contradicting;
        agreement.contradicting_weight += other.weight;
      } else if (say == Say::kSame) {
        ++agreement.agreeing;
        agreement.agreeing_weight += other.weight;
        if (way_m(own, other) <= nearest_m) {
          nearest_m = way_m(own, other);
          agreement.nearest_agreeing = other.id;
        }
      }
    }
  }
  return agreements;
}

std::optional<std::size_t> suggest_correction(std::span<const Correction> corrections,
                                              std::span<const Agreement> agreements, const Correction& pair,
                                              const AgreementOptions& options) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (!comparable(pair, corrections[i], options) || agreements[i].agreeing < kSupported) continue;
    const bool better = !best || agreements[i].agreeing_weight > agreements[*best].agreeing_weight ||
                        (agreements[i].agreeing_weight == agreements[*best].agreeing_weight &&
                         way_m(pair, corrections[i]) < way_m(pair, corrections[*best]));
    if (better) best = i;
  }
  return best;
}

}  // namespace kilter
