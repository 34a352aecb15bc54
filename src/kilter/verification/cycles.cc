// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/cycles.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace kilter {
namespace {

constexpr std::size_t kEnoughCycles = 10;
// Where more submaps see one place, each is asked with so many of them, evenly spaced: a median needs no more.
constexpr std::size_t kMostPartners = 64;
constexpr double kMedianPerDegree = 5.348 / 6.0;  // of chi-squared with 6 degrees of freedom

struct Uncertain {
  Pose3 T;
  Matrix6 covariance;  // of xi in T * Exp(xi)
};

Uncertain inverse(const Uncertain& pose) {
  const Matrix6 Ad = adjoint(pose.T);
  return {pose.T.inverse(), Ad * pose.covariance * Ad.transpose()};
}

Uncertain chained(const Uncertain& first, const Uncertain& second) {
  const Matrix6 Ad = adjoint(second.T.inverse());
  return {first.T * second.T, Ad * first.covariance * Ad.transpose() + second.covariance};
}

// Both ways round: neighbours[a][b] brings b's points into a's frame.
using Neighbours = std::map<SubmapId, std::map<SubmapId, Uncertain>>;

Neighbours neighbours_of(std::span<const RelativePose> poses) {
  Neighbours neighbours;
  for (const RelativePose& pose : poses) {
    const Uncertain forward{pose.T_target_source, pose.covariance};
    neighbours[pose.id.target].insert_or_assign(pose.id.source, forward);
    neighbours[pose.id.source].insert_or_assign(pose.id.target, inverse(forward));
  }
  return neighbours;
}

using Neighbour = const std::pair<const SubmapId, Uncertain>*;

std::vector<Neighbour> later_partners(const SubmapId& of, const std::map<SubmapId, Uncertain>& neighbours) {
  std::vector<Neighbour> later;
  for (auto at = neighbours.upper_bound(of); at != neighbours.end(); ++at) later.push_back(&*at);
  if (later.size() <= kMostPartners) return later;
  std::vector<Neighbour> some;
  for (std::size_t k = 0; k < kMostPartners; ++k) some.push_back(later[k * later.size() / kMostPartners]);
  return some;
}

// Squares left over per degree of freedom; absent where the covariances leave no room to judge.
std::optional<double> nees_of(const Uncertain& loop) {
  const Eigen::LDLT<Matrix6> factors(loop.covariance);
  if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Vector6 left = loop.T.log();
  const double square = left.dot(factors.solve(left)) / 6.0;
  return std::isfinite(square) ? std::optional(square) : std::nullopt;
}

}  // namespace

CycleClosure close_cycles(std::span<const RelativePose> poses) {
  const Neighbours neighbours = neighbours_of(poses);
  std::map<SubmapId, std::vector<Neighbour>> partners;
  for (const auto& [a, of_a] : neighbours) partners[a] = later_partners(a, of_a);
  std::vector<double> squares;
  for (const auto& [a, of_a] : neighbours) {
    for (const Neighbour b : partners.at(a)) {
      for (const Neighbour c : partners.at(b->first)) {
        const auto back = of_a.find(c->first);
        if (back == of_a.end()) continue;
        if (auto nees = nees_of(chained(chained(b->second, c->second), inverse(back->second))))
          squares.push_back(*nees);
      }
    }
  }
  CycleClosure closure;
  closure.closed = squares.size();
  if (squares.empty()) return closure;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  closure.nees_median = *middle;
  if (closure.closed >= kEnoughCycles) closure.covariance_scale = std::max(1.0, *middle / kMedianPerDegree);
  return closure;
}

}  // namespace kilter
