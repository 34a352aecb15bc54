// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/register_clouds.h"

#include <gtest/gtest.h>

#include <atomic>

namespace kilter {
namespace {

// A floor and two walls, 3 m wide, with a corner at (x, 0, 0).
PointCloud corner_at(float x) {
  PointCloud cloud;
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 60; ++k) {
      const float a = 0.05F * static_cast<float>(i) + 0.01F;
      const float b = 0.05F * static_cast<float>(k) + 0.02F;
      cloud.add(x + a, b, 0.0F);
      cloud.add(x, a, b);
      cloud.add(x + a, 0.0F, b);
    }
  }
  return cloud;
}

TEST(RegisterClouds, BringsOneCloudOntoTheOther) {
  const auto pair = register_clouds({corner_at(0.0F), corner_at(0.2F), Pose3()}, {}, {});
  ASSERT_TRUE(pair) << to_string(pair.error());
  ASSERT_TRUE(pair->evidence.registration && pair->evidence.registration->converged());
  EXPECT_NEAR(pair->evidence.registration->T_target_source.translation_m().x(), -0.2, 0.01);
}

TEST(RegisterClouds, HasARegistrationThatFailedWhereNothingMeets) {
  const Pose3 init = Pose3::from_translation(1.0, 2.0, 3.0);
  const auto pair = register_clouds({corner_at(0.0F), corner_at(500.0F), init}, {}, {});
  ASSERT_TRUE(pair) << to_string(pair.error());
  ASSERT_TRUE(pair->evidence.registration.has_value());
  EXPECT_FALSE(pair->evidence.registration->converged());
  EXPECT_EQ(pair->evidence.registration->T_target_source.translation_m(), init.translation_m());
}

TEST(RegisterClouds, StopsWhenAsked) {
  const std::atomic<bool> cancelled = true;
  const auto pair = register_clouds({corner_at(0.0F), corner_at(0.2F), Pose3()}, {}, {.cancelled = &cancelled});
  ASSERT_FALSE(pair);
  EXPECT_EQ(pair.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace kilter
