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

// What GTSAM's between factor takes, its blocks in the file's order: the rotation vector and the translation of the
// difference in the source's frame.
Vector6 gtsam_error(const Pose3& measured, const Pose3& actual) { return (measured.inverse() * actual).log(); }

// What Ceres' pose graph example takes.
Vector6 ceres_error(const Pose3& measured, const Pose3& actual) {
  Eigen::Quaterniond turn = measured.rotation() * actual.rotation().conjugate();
  if (turn.w() < 0.0) turn.coeffs() *= -1.0;
  Vector6 error;
  error << actual.translation_m() - measured.translation_m(), 2.0 * turn.vec();
  return error;
}

Vector6 error_of(G2oDialect dialect, const Pose3& measured, const Pose3& actual) {
  switch (dialect) {
    case G2oDialect::kG2o:
      return g2o_error(measured, actual);
    case G2oDialect::kGtsam:
      return gtsam_error(measured, actual);
    case G2oDialect::kCeres:
      return ceres_error(measured, actual);
  }
  return {};
}

// What a reader's squared errors are weighed by: Ceres' example multiplies errors by the lower factor.
Matrix6 weights_of(G2oDialect dialect, const Matrix6& read) {
  if (dialect != G2oDialect::kCeres) return read;
  const Matrix6 root = read.llt().matrixL();
  return root.transpose() * root;
}

// Finds the pose that two contradicting edges between the same two vertices settle on, as an optimiser that reads the
// dialect would: Gauss-Newton with numeric derivatives.
Pose3 settle(G2oDialect dialect, const std::vector<Pose3>& measured, const std::vector<Matrix6>& covariances) {
  Pose3 pose = measured.front();
  for (int iteration = 0; iteration < 20; ++iteration) {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const Matrix6 information = weights_of(dialect, *information_for(dialect, covariances[k], measured[k]));
      const Vector6 error = error_of(dialect, measured[k], pose);
      Matrix6 J;
      for (int axis = 0; axis < 6; ++axis) {
        const Vector6 step = 1e-6 * Vector6::Unit(axis);
        J.col(axis) = (error_of(dialect, measured[k], pose * Pose3::exp(step)) -
                       error_of(dialect, measured[k], pose * Pose3::exp(-step))) /
                      2e-6;
      }
      H += J.transpose() * information * J;
      g += J.transpose() * information * error;
    }
    pose = pose * Pose3::exp(-H.ldlt().solve(g));
  }
  return pose;
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
    const auto information = information_for(G2oDialect::kG2o, covariance, {});
    ASSERT_TRUE(information);
    const double cost = error.dot(*information * error);
    const double expected = xi.dot(covariance.inverse() * xi);
    EXPECT_NEAR(cost, expected, 1e-3 * expected);
  }
}

TEST(ConstraintsG2o, EveryReaderPaysTheMahalanobisDistance) {
  Rng rng(4, 0);
  for (const G2oDialect dialect : {G2oDialect::kG2o, G2oDialect::kGtsam, G2oDialect::kCeres}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix6 covariance = random_covariance(rng);
      Vector6 xi;
      for (double& entry : xi) entry = 1e-4 * rng.normal();
      Vector6 start;
      for (double& entry : start) entry = rng.normal();
      const Pose3 measured = Pose3::exp(start);
      const Vector6 error = error_of(dialect, measured, measured * Pose3::exp(xi));
      const auto information = information_for(dialect, covariance, measured);
      ASSERT_TRUE(information);
      const double expected = xi.dot(covariance.inverse() * xi);
      EXPECT_NEAR(error.dot(weights_of(dialect, *information) * error), expected, 1e-3 * expected)
          << static_cast<int>(dialect);
    }
  }
}

TEST(ConstraintsG2o, AGraphSettlesOnTheSamePosesInEveryDialect) {
  Rng rng(5, 0);
  Vector6 start;
  start << 3.0, -2.0, 0.5, 0.2, -0.1, 1.1;
  const Pose3 first = Pose3::exp(start);
  Vector6 apart;
  apart << 0.02, -0.01, 0.015, 0.004, 0.002, -0.003;
  const std::vector<Pose3> measured = {first, first * Pose3::exp(apart)};
  const std::vector<Matrix6> covariances = {1e-4 * random_covariance(rng), 1e-4 * random_covariance(rng)};
  const Pose3 reference = settle(G2oDialect::kG2o, measured, covariances);
  EXPECT_GT((reference.inverse() * measured[0]).log().norm(), 1e-3);  // both pull
  for (const G2oDialect dialect : {G2oDialect::kGtsam, G2oDialect::kCeres}) {
    const Vector6 difference = (reference.inverse() * settle(dialect, measured, covariances)).log();
    EXPECT_LT(difference.norm(), 2e-4) << static_cast<int>(dialect);
  }
}

TEST(ConstraintsG2o, CovariancesThatCannotBeInvertedGiveNoInformation) {
  Matrix6 covariance = Matrix6::Identity();
  covariance(3, 3) = 0.0;
  EXPECT_FALSE(information_for(G2oDialect::kG2o, covariance, {}));
  covariance(3, 3) = -1.0;
  EXPECT_FALSE(information_for(G2oDialect::kG2o, covariance, {}));
  covariance(3, 3) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(information_for(G2oDialect::kG2o, covariance, {}));
  covariance(3, 3) = 1.0;
  covariance(3, 4) = covariance(4, 3) = 1.0;
  EXPECT_FALSE(information_for(G2oDialect::kG2o, covariance, {}));
}

// Millimetres about a place a kilometre from the source's origin, and a heading that nothing fixes.
TEST(ConstraintsG2o, AFreeTurnFarFromTheOriginStillMakesAnEdge) {
  const double free_rad = 0.03;
  Vector6 variances;
  variances << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, free_rad * free_rad;
  Matrix6 moved = Matrix6::Identity();
  moved.topRightCorner<3, 3>() = skew({1000.0, 200.0, 0.0});  // v at the origin = v there + c x w
  const Matrix6 covariance = moved * variances.asDiagonal() * moved.transpose();
  const auto information = information_for(G2oDialect::kGtsam, covariance, {});
  ASSERT_TRUE(information);
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6 step = std::sqrt(variances[axis]) * moved.col(axis);
    EXPECT_NEAR(step.dot(*information * step), 1.0, 1e-3) << axis;
  }
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
