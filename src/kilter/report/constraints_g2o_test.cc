// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/constraints_g2o.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "testing/results.h"

namespace kilter {
namespace {

// What g2o takes for the error of an edge: translation, then the vector part of the quaternion.
Vector6 g2o_error(const Pose3& measured, const Pose3& actual) {
  const Pose3 difference = measured.inverse() * actual;
  Vector6 error;
  error << difference.translation_m(), difference.rotation().vec() * (difference.rotation().w() < 0.0 ? -1.0 : 1.0);
  return error;
}

Matrix6 random_covariance(Rng& rng) {
  Matrix6 a;
  for (double& entry : a.reshaped()) entry = rng.normal();
  return a * a.transpose() + 0.1 * Matrix6::Identity();
}

TEST(ConstraintsG2o, TheCostOfASmallErrorIsItsMahalanobisDistance) {
  Rng rng(3, 0);
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix6 covariance = random_covariance(rng);
    Vector6 xi;
    for (double& entry : xi) entry = 1e-4 * rng.normal();
    Vector6 start;
    for (double& entry : start) entry = rng.normal();
    const Pose3 measured = Pose3::exp(start);
    const Vector6 error = g2o_error(measured, measured * Pose3::exp(xi));
    const auto information = g2o_information(covariance);
    ASSERT_TRUE(information);
    const double cost = error.dot(*information * error);
    const double expected = xi.dot(covariance.inverse() * xi);
    EXPECT_NEAR(cost, expected, 1e-3 * expected);
  }
}

TEST(ConstraintsG2o, CovariancesThatCannotBeInvertedGiveNoInformation) {
  Matrix6 covariance = Matrix6::Identity();
  covariance(3, 3) = 0.0;
  EXPECT_FALSE(g2o_information(covariance));
  covariance(3, 3) = -1.0;
  EXPECT_FALSE(g2o_information(covariance));
  covariance(3, 3) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(g2o_information(covariance));
  covariance(3, 3) = 1e-18;
  EXPECT_FALSE(g2o_information(covariance));
}

TEST(ConstraintsG2o, HoldsAVertexPerSubmapAndAnEdgePerTrustedPair) {
  Result result = testing::small_result();
  result.pairs[1].trusted = false;
  std::istringstream text(constraints_g2o(result));
  int vertices = 0;
  int edges = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string tag;
    words >> tag;
    std::vector<double> numbers;
    for (double number = 0.0; words >> number;) numbers.push_back(number);
    if (tag == "VERTEX_SE3:QUAT") {
      ASSERT_EQ(numbers.size(), 8U);
      EXPECT_EQ(numbers[0], vertices++);
    } else if (tag == "EDGE_SE3:QUAT") {
      ++edges;
      ASSERT_EQ(numbers.size(), 2U + 7U + 21U);
      EXPECT_EQ(numbers[0], 0.0) << "target";
      EXPECT_EQ(numbers[1], 1.0) << "source";
      EXPECT_EQ(numbers[2], 0.52);
      EXPECT_NEAR(numbers[9], 1e6, 1e-3);             // 1 / 1e-6 m^2
      EXPECT_NEAR(numbers[9 + 15], 4.0 * 1e8, 1e-1);  // four times 1 / 1e-8 rad^2
    } else {
      EXPECT_EQ(tag, "#") << line;
    }
  }
  EXPECT_EQ(vertices, 3);
  EXPECT_EQ(edges, 1);
}

TEST(ConstraintsG2o, AnEdgeWithoutInformationIsNamedInAComment) {
  Result result = testing::result_of({{"a", 2}});
  testing::add_measured_pair(result, 1, 0).covariance->setZero();
  const std::string text = constraints_g2o(result);
  EXPECT_EQ(text.find("EDGE_SE3:QUAT"), std::string::npos);
  EXPECT_NE(text.find("# a/1 <- a/2: covariance cannot be inverted, no edge"), std::string::npos);
}

TEST(ConstraintsG2o, ANameCannotBreakOutOfItsComment) {
  Result result = testing::result_of({{"x\nEDGE_SE3:QUAT 0 0", 1}});
  EXPECT_EQ(constraints_g2o(result).find("\nEDGE"), std::string::npos);
}

}  // namespace
}  // namespace kilter
