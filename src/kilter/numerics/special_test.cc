// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/special.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "kilter/numerics/certified_table.h"

namespace kilter {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Special, FunctionsMatchTheCertifiedTable) {
  const auto rows = load_certified("special.csv");
  ASSERT_GE(rows.size(), 50U);
  double worst = 0.0;
  for (const auto& row : rows) {
    const double argument = number_of(row[1]);
    const double expected = number_of(row[2]);
    const double found = row[0] == "erfcx" ? erfcx(argument) : log_normal_tail(argument);
    const double allowed = std::max(4e-15 * std::abs(expected), 4 * std::numeric_limits<double>::denorm_min());
    EXPECT_NEAR(found, expected, allowed) << row[0] << "(" << row[1] << ")";
    if (std::abs(expected) > 1e-300) worst = std::max(worst, std::abs(found / expected - 1.0));
  }
  RecordProperty("worst_relative_error", std::to_string(worst * 1e15) + "e-15");
}

TEST(Special, ErfcxIsErfcScaledWhereErfcIsNotSmall) {
  for (double x = -3.0; x < 3.0; x += 0.01) {
    const double expected = std::exp(x * x) * std::erfc(x);
    EXPECT_NEAR(erfcx(x), expected, 1e-14 * expected) << x;
  }
}

TEST(Special, FunctionsHaveTheirLimits) {
  EXPECT_EQ(erfcx(kInfinity), 0.0);
  EXPECT_EQ(erfcx(-27.0), kInfinity);
  EXPECT_EQ(erfcx(-kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(erfcx(std::nan(""))));
  EXPECT_EQ(log_normal_tail(kInfinity), -kInfinity);
  EXPECT_EQ(log_normal_tail(-kInfinity), 0.0);
  EXPECT_TRUE(std::isnan(log_normal_tail(std::nan(""))));
}

TEST(Special, LogTailsOfBothSidesSumToOne) {
  for (double z = 0.0; z < 8.0; z += 0.125) {
    EXPECT_NEAR(std::exp(log_normal_tail(z)) + std::exp(log_normal_tail(-z)), 1.0, 2e-15) << z;
  }
}

}  // namespace
}  // namespace kilter
