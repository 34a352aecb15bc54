// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/log_quadratic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

struct Node {
  double x;
  double weight;
};

// Positive half of the 16-point Gauss-Legendre rule on [-1, 1]; exact to degree 31.
constexpr std::array<Node, 8> kHalfRule = {{{0.095012509837637440185, 0.18945061045506849629},
                                            {0.28160355077925891323, 0.18260341504492358887},
                                            {0.45801677765722738634, 0.16915651939500253819},
                                            {0.61787624440264374845, 0.14959598881657673208},
                                            {0.75540440835500303390, 0.12462897125553387205},
                                            {0.86563120238783174388, 0.095158511682492784810},
                                            {0.94457502307323257608, 0.062253523938647892863},
                                            {0.98940093499164993260, 0.027152459411754094852}}};

// Six panels bring the rule's own error for exp(-45) at the ends, normal or exponential, below 1e-19.
constexpr int kPanels = 6;
constexpr std::size_t kNodes = 2 * kHalfRule.size() * kPanels;
constexpr double kDepth = 45.0;  // exp(-45) * 45^4 < 1e-13 of an ulp in every moment

// The v > 0 where the weight has fallen to exp(-kDepth); infinite if it never does.
double reach(double slope, double curvature) {
  const double bend = 2.0 * kDepth * curvature;
  // Neither form squares the slope, which may be huge: a parent far narrower than its distance to the interval.
  const double root = bend >= 0.0 ? std::hypot(slope, std::sqrt(bend)) : slope * std::sqrt(1.0 + bend / slope / slope);
  const double sum = slope + root;
  // A negative curvature may keep the weight above the depth everywhere: root is NaN, and nothing is cut.
  return sum > 0.0 ? 2.0 * kDepth / sum : std::numeric_limits<double>::infinity();
}

// The composite rule on [0, 1], from left to right.
std::array<Node, kNodes> unit_rule() {
  std::array<Node, kNodes> rule{};
  constexpr int kPoints = 2 * static_cast<int>(kHalfRule.size());
  for (int panel = 0; panel < kPanels; ++panel) {
    for (int i = 0; i < kPoints; ++i) {
      const int half = kPoints / 2;
      const Node& node = kHalfRule[static_cast<std::size_t>(i < half ? half - 1 - i : i - half)];
      const double x = i < half ? -node.x : node.x;
      rule[static_cast<std::size_t>(panel) * kPoints + static_cast<std::size_t>(i)] = {
          (panel + 0.5 + 0.5 * x) / kPanels, 0.5 * node.weight / kPanels};
    }
  }
  return rule;
}

}  // namespace

LogQuadraticMoments LogQuadratic::moments() const {
  KILTER_EXPECTS(slope >= 0.0 && low <= 0.0 && high >= 0.0 && (slope == 0.0 || low == 0.0));
  static const std::array<Node, kNodes> kRule = unit_rule();
  const double cut = reach(slope, curvature);
  LogQuadraticMoments result;
  result.start = std::max(low, -cut);
  result.length = std::min(high, cut) - result.start;

  std::array<double, kNodes> weights{};
  double first = 0.0;
  for (std::size_t i = 0; i < kNodes; ++i) {
    weights[i] = kRule[i].weight * std::exp(log_weight(result.start + result.length * kRule[i].x));
    result.unit_mass += weights[i];
    first += weights[i] * kRule[i].x;
  }
  result.unit_mean = first / result.unit_mass;
  for (std::size_t i = 0; i < kNodes; ++i) {
    const double deviation = kRule[i].x - result.unit_mean;
    const double share = weights[i] / result.unit_mass * deviation * deviation;
    result.unit_variance += share;
    result.unit_third += share * deviation;
    result.unit_fourth += share * deviation * deviation;
  }
  return result;
}

}  // namespace kilter
