// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/map_ply.h"
#include "kilter/report/palette.h"

#include <cstring>
#include <set>

#include <gmock/gmock.h>

namespace kilter {
namespace {

constexpr std::size_t kBytes = 31;

TEST(MapPly, AVoxelReadsBackAsItWas) {
  FusedMap map{"global", {{{4.5e6, -0.1, 12.25}, 0.0, 0}, {{1.0, 2.0, 3.0}, 2.0, 1}}};
  std::vector<RobotSummary> robots(2);
  robots[0].name = "a";
  robots[1].name = "b";
  const std::string ply = map_ply(map, robots);
  const std::string end = "end_header\n";
  const std::size_t body = ply.find(end) + end.size();
  EXPECT_THAT(ply.substr(0, body), ::testing::HasSubstr("format binary_little_endian 1.0\n"));
  EXPECT_THAT(ply.substr(0, body), ::testing::HasSubstr("element vertex 2\n"));
  EXPECT_THAT(ply.substr(0, body), ::testing::HasSubstr("comment robot b 240 149 10\n"));
  ASSERT_EQ(ply.size(), body + 2 * kBytes);
  double xyz[3];
  std::memcpy(xyz, ply.data() + body, sizeof(xyz));
  EXPECT_THAT(xyz, ::testing::ElementsAre(4.5e6, -0.1, 12.25));
  EXPECT_EQ(static_cast<unsigned char>(ply[body + kBytes + 24]), 240);
  float probability = 0.0F;
  std::memcpy(&probability, ply.data() + body + 27, sizeof(float));
  EXPECT_EQ(probability, 0.5F);
}

TEST(MapPly, AnEmptyMapIsAHeader) {
  const std::string ply = map_ply({"global", {}}, {});
  EXPECT_TRUE(ply.ends_with("end_header\n"));
  EXPECT_THAT(ply, ::testing::HasSubstr("element vertex 0\n"));
}

TEST(MapPly, EightRobotsHaveEightColours) {
  std::set<std::array<std::uint8_t, 3>> colours;
  for (int robot = 0; robot < 8; ++robot) colours.insert(robot_colour(robot));
  EXPECT_EQ(colours.size(), 8U);
  EXPECT_EQ(robot_colour(8), robot_colour(0));
}

}  // namespace
}  // namespace kilter
