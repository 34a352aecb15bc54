// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace kilter {
namespace {

constexpr double kSlack_m = 0.1;  // what a submap may be bent by
constexpr double kSigmas = 2.0;
constexpr double kInformative_m = 0.5;  // allowances below it always tell something
constexpr double kInformativeShare = 0.5;
constexpr int kSupported = 2;

constexpr double kRounding_m = 1e-6;

using Key = std::tuple<int, int, double>;

Key key_of(const Correction& correction) {
  return {correction.source_robot, correction.target_robot, correction.source_path_m};
}

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

// Whether what one says of another place, give or take this, tells anything of a move by so much.
bool is_informative(double allowance_m, double moved_m) {
  return allowance_m <= std::max(kInformative_m, kInformativeShare * moved_m);
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
  if (!is_informative(allowance_m, asked_m)) return Say::kNothing;
  // Carried over as one rigid motion, or as the same shift: where each submap is tilted in its own way, as odometry
  // without a tilt sensor leaves them, the turn of one says nothing about the other.
  const double apart_m = std::min((to_a_m - to_b_m).norm(), (shift_a_m - shift_b_m).norm());
  return apart_m <= allowance_m ? Say::kSame : Say::kOther;
}

}  // namespace

CorrectionIndex::CorrectionIndex(std::span<const Correction> corrections, const AgreementOptions& options)
    : corrections_(corrections), options_(options), order_(corrections.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [&](std::size_t a, std::size_t b) { return key_of(corrections_[a]) < key_of(corrections_[b]); });
}

std::vector<std::size_t> CorrectionIndex::near(const Correction& own) const {
  // Rounding must not lose one at the border; comparable() decides.
  const double reach_m = options_.neighbourhood_m + kRounding_m;
  Key first = key_of(own);
  std::get<2>(first) -= reach_m;
  Key last = key_of(own);
  std::get<2>(last) += reach_m;
  std::vector<std::size_t> found;
  auto place = std::lower_bound(order_.begin(), order_.end(), first,
                                [&](std::size_t i, const Key& key) { return key_of(corrections_[i]) < key; });
  for (; place != order_.end() && key_of(corrections_[*place]) <= last; ++place) {
    if (comparable(own, corrections_[*place], options_)) found.push_back(*place);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Agreement> compare_corrections(const CorrectionIndex& index) {
  const std::span<const Correction> corrections = index.corrections();
  const AgreementOptions& options = index.options();
  std::vector<Agreement> agreements(corrections.size());
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& own = corrections[i];
    Agreement& agreement = agreements[i];
    double nearest_m = options.neighbourhood_m;
    for (const std::size_t k : index.near(own)) {
      const Correction& other = corrections[k];
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

std::vector<int> count_vouching(const CorrectionIndex& index, std::span<const Standing> standings) {
  const std::span<const Correction> corrections = index.corrections();
  std::vector<int> vouching(corrections.size(), 0);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& own = corrections[i];
    bool denied = false;
    for (const std::size_t k : index.near(own)) {
      if (standings[k] == Standing::kDoubted || !close_over_same_way(own, corrections[k])) continue;
      const Say say = compare(own, corrections[k], index.options());
      if (standings[k] == Standing::kMoves && say == Say::kSame) ++vouching[i];
      if (standings[k] == Standing::kStays && say == Say::kOther) denied = true;
    }
    if (denied) vouching[i] = 0;
  }
  return vouching;
}

int count_movers(const CorrectionIndex& index, std::span<const Standing> standings, const Correction& pair,
                 double tolerance_m) {
  struct Place {
    Eigen::Vector3d to_m;
    double allowance_m;
  };
  std::vector<Place> places;
  bool of_source = false;
  bool of_target = false;
  for (const std::size_t k : index.near(pair)) {
    const Correction& other = index.corrections()[k];
    if (standings[k] == Standing::kDoubted || !close_over_same_way(pair, other)) continue;
    const Eigen::Vector3d to_m = other.T_world_correction * pair.centre_world_m;
    const double moved_m = (to_m - pair.centre_world_m).norm();
    const double turn_m = other.sigma_rad * (pair.centre_world_m - other.centre_world_m).norm();
    const double allowance_m =
        kSlack_m + kSigmas * std::hypot(other.sigma_m, turn_m) + index.options().drift_per_metre * way_m(pair, other);
    if (!is_informative(allowance_m, moved_m)) continue;
    if (standings[k] == Standing::kStays || moved_m - allowance_m <= tolerance_m) return 0;
    for (const Place& place : places) {
      if ((place.to_m - to_m).norm() > place.allowance_m + allowance_m) return 0;
    }
    places.push_back({to_m, allowance_m});
    of_source = of_source || other.id.source == pair.id.source;
    of_target = of_target || other.id.target == pair.id.target;
  }
  return of_source && of_target ? static_cast<int>(places.size()) : 0;
}

std::optional<std::size_t> suggest_correction(const CorrectionIndex& index, std::span<const Agreement> agreements,
                                              const Correction& pair) {
  const std::span<const Correction> corrections = index.corrections();
  std::optional<std::size_t> best;
  for (const std::size_t i : index.near(pair)) {
    if (agreements[i].agreeing < kSupported) continue;
    const bool better = !best || agreements[i].agreeing_weight > agreements[*best].agreeing_weight ||
                        (agreements[i].agreeing_weight == agreements[*best].agreeing_weight &&
                         way_m(pair, corrections[i]) < way_m(pair, corrections[*best]));
    if (better) best = i;
  }
  return best;
}

}  // namespace kilter
