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
constexpr double kSameShare = 0.5;  // of a move: what vouches for it is no farther from it
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

// How far two corrections may put one's place apart and still be the same.
double allowance_m(const Correction& own, const Correction& other, const AgreementOptions& options) {
  const double turn_m = other.sigma_rad * (own.centre_world_m - other.centre_world_m).norm();
  const double sigma_m = std::sqrt(own.sigma_m * own.sigma_m + other.sigma_m * other.sigma_m + turn_m * turn_m);
  return kSlack_m + kSigmas * sigma_m + options.drift_per_metre * way_m(own, other);
}

Eigen::Vector3d shift_m(const Correction& correction, const Eigen::Vector3d& place_m) {
  return correction.T_world_correction * place_m - place_m;
}

// Two corrections at the first one's place.
struct Comparison {
  double own_m = 0.0;    // how far the first asks to move
  double other_m = 0.0;  // the second, where its own overlap is
  double apart_m = 0.0;
  double allowance_m = 0.0;

  [[nodiscard]] bool tells() const { return is_informative(allowance_m, std::max(own_m, other_m)); }
  [[nodiscard]] bool same() const { return tells() && apart_m <= allowance_m; }
  [[nodiscard]] bool other() const { return tells() && apart_m > allowance_m; }
};

Comparison compare(const Correction& own, const Correction& other, const AgreementOptions& options) {
  const Eigen::Vector3d own_m = shift_m(own, own.centre_world_m);
  const Eigen::Vector3d other_m = shift_m(other, other.centre_world_m);
  // Carried over as one rigid motion, or as the same shift: where each submap is tilted in its own way, as odometry
  // without a tilt sensor leaves them, the turn of one says nothing about the other.
  const double apart_m = std::min((own_m - shift_m(other, own.centre_world_m)).norm(), (own_m - other_m).norm());
  return {own_m.norm(), other_m.norm(), apart_m, allowance_m(own, other, options)};
}

// Whether some pairs share their source with one, some their target, and some neither.
struct Sides {
  bool source = false;
  bool target = false;
  bool neither = false;

  void add(const PairId& own, const PairId& other) {
    source = source || other.source == own.source;
    target = target || other.target == own.target;
    neither = neither || (other.source != own.source && other.target != own.target);
  }
  [[nodiscard]] bool both() const { return source && target; }
  [[nodiscard]] bool all() const { return both() && neither; }
};

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
    for (const std::size_t k : index.near(own)) {
      const Correction& other = corrections[k];
      const Comparison here = compare(own, other, options);
      if (here.other() && close_over_same_way(own, other)) {
        ++agreement.contradicting;
        agreement.contradicting_weight += other.weight;
      } else if (here.same()) {
        ++agreement.agreeing;
        agreement.agreeing_weight += other.weight;
      }
    }
  }
  return agreements;
}

std::vector<int> count_vouching(const CorrectionIndex& index, std::span<const Standing> standings, double tolerance_m) {
  const std::span<const Correction> corrections = index.corrections();
  std::vector<int> vouching(corrections.size(), 0);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& own = corrections[i];
    int count = 0;
    bool denied = false;
    Sides sides;
    for (const std::size_t k : index.near(own)) {
      if (standings[k] == Standing::kDoubted || !close_over_same_way(own, corrections[k])) continue;
      const Comparison here = compare(own, corrections[k], index.options());
      const bool same = here.same() && here.apart_m <= kSameShare * here.own_m;
      denied = denied || (standings[k] == Standing::kStays && here.tells() && !same);
      if (standings[k] != Standing::kMoves || !same) continue;
      if (std::min(here.own_m, here.other_m) <= tolerance_m) continue;
      ++count;
      sides.add(own.id, corrections[k].id);
    }
    if (!denied && sides.both()) vouching[i] = count;
  }
  return vouching;
}

int count_movers(const CorrectionIndex& index, std::span<const Standing> standings, const Correction& pair,
                 double tolerance_m) {
  struct Neighbour {
    std::size_t number;
    Eigen::Vector3d carried_m;
    double moved_m;
    double allowance_m;
  };
  std::vector<Neighbour> neighbours;
  double most_m = 0.0;
  for (const std::size_t k : index.near(pair)) {
    const Correction& other = index.corrections()[k];
    if (standings[k] == Standing::kDoubted || !close_over_same_way(pair, other)) continue;
    const Eigen::Vector3d rigid_m = shift_m(other, pair.centre_world_m);
    const double moved_m = std::min(rigid_m.norm(), shift_m(other, other.centre_world_m).norm());
    neighbours.push_back({k, rigid_m, moved_m, allowance_m(pair, other, index.options())});
    most_m = std::max(most_m, moved_m);
  }
  std::erase_if(neighbours, [&](const Neighbour& one) { return !is_informative(one.allowance_m, most_m); });
  Sides sides;
  for (const Neighbour& one : neighbours) {
    if (standings[one.number] == Standing::kStays || one.moved_m - one.allowance_m <= tolerance_m) return 0;
    for (const Neighbour& other : neighbours) {
      if ((one.carried_m - other.carried_m).norm() > one.allowance_m + other.allowance_m) return 0;
    }
    sides.add(pair.id, index.corrections()[one.number].id);
  }
  return sides.all() ? static_cast<int>(neighbours.size()) : 0;
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
