// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/consistency_matrix.h"

#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

namespace kilter {
namespace {

PairId pair(int source, int target) { return {.source = {source}, .target = {target}}; }

TEST(PairMatrix, HoldsWhatWasSetAndNothingElse) {
  ConsistencyMatrix gamma(3);
  EXPECT_EQ(gamma.size(), 3);
  EXPECT_TRUE(gamma.entries().empty());
  gamma.set(pair(1, 0), 4.0);
  gamma.set(pair(1, 0), 5.0);
  EXPECT_EQ(gamma.get(pair(1, 0)), 5.0);
  EXPECT_FALSE(gamma.get(pair(0, 1)).has_value());
  EXPECT_EQ(gamma.entries().size(), 1U);
}

TEST(PairMatrix, IsReadRowByRowWhateverTheOrderOfSetting) {
  ConsistencyMatrix one(4);
  ConsistencyMatrix two(4);
  const std::vector<PairId> rows = {pair(1, 0), pair(2, 0), pair(2, 1), pair(3, 2)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    one.set(rows[i], static_cast<double>(rows[i].source.value));
    const PairId other = rows[rows.size() - 1 - i];
    two.set(other, static_cast<double>(other.source.value));
  }
  EXPECT_EQ(one, two);
  std::vector<PairId> seen;
  for (const auto& [id, value] : two.entries()) seen.push_back(id);
  EXPECT_EQ(seen, rows);
}

TEST(Verified, IsThetaMinusGammaWhereBothExist) {
  ConsistencyMatrix gamma(3);
  ConsistencyMatrix theta(3);
  gamma.set(pair(1, 0), 10.0);
  gamma.set(pair(2, 0), 20.0);  // registration failed: no theta
  theta.set(pair(1, 0), 90.0);
  theta.set(pair(2, 1), 7.0);  // gamma was infinite
  const InconsistencyMatrix difference = verified(theta, gamma);
  EXPECT_EQ(difference.size(), 3);
  EXPECT_EQ(difference.entries().size(), 1U);
  EXPECT_EQ(difference.get(pair(1, 0)), 80.0);
}

TEST(Verified, OfAMapThatRegistrationCannotImproveIsZeroNotAbsent) {
  ConsistencyMatrix gamma(2);
  gamma.set(pair(1, 0), 10.0);
  EXPECT_EQ(verified(gamma, gamma).get(pair(1, 0)), 0.0);
}

TEST(PairMatrix, OfOppositeSignAreDifferentTypes) {
  EXPECT_FALSE((std::is_convertible_v<InconsistencyMatrix, ConsistencyMatrix>));
}

}  // namespace
}  // namespace kilter
