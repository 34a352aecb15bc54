// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/frame_words.h"

#include <gtest/gtest.h>

#include "testing/results.h"

namespace kilter {
namespace {

TEST(FrameWords, TellShiftAndTurnWithTheirSigns) {
  Result result;
  for (const char* name : {"a", "b"}) result.robots.push_back({name, 10, 20.0, 2, false});
  FrameOffset frame;
  frame.source_robot = 1;
  frame.shift_m = {-0.09, 0.384, -0.001};
  frame.agreeing = 41;
  frame.witnesses = 42;
  EXPECT_EQ(frame_words(result, frame),
            "b as a whole, its middle shifted by x-9 y+38 z+0 cm in world axes, would meet a in 41 of 42 pairs");
  frame.T_world_correction = Pose3::exp((Vector6() << 0, 0, 0, 0, 0, -0.02).finished());
  EXPECT_NE(frame_words(result, frame).find(" and all turned by -1.1 deg,"), std::string::npos);
  frame.T_world_correction = Pose3::exp((Vector6() << 0, 0, 0, 0.02, 0, 0).finished());
  EXPECT_NE(frame_words(result, frame).find(" and all tilted by 1.1 deg,"), std::string::npos);
}

}  // namespace
}  // namespace kilter
