// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_list.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

TEST(PoseList, TellsLayoutsByTheirFirstLines) {
  EXPECT_EQ(guess_pose_layout("0 1 2 3 0 0 0 1\n"), PoseLayout::kTum);
  EXPECT_EQ(guess_pose_layout("# t x y z\n\n0,1,2,3,0,0,0,1 # first\n"), PoseLayout::kTum);
  EXPECT_EQ(guess_pose_layout("1 0 0 0 0 1 0 0 0 0 1 0\n"), PoseLayout::kKitti);
  EXPECT_EQ(guess_pose_layout("FIX 0\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"), PoseLayout::kG2o);
  EXPECT_EQ(guess_pose_layout("t,x,y,z,qx,qy,qz,qw\n"), PoseLayout::kTable);
  for (const char* text :
       {"", "# only a comment\n", "A text about clouds.\n", "1 2 3\n", "0 1 2 3 0 0 0 b\n", "\xEF\xBB\xBF"}) {
    EXPECT_FALSE(guess_pose_layout(text)) << text;
  }
}

TEST(PoseList, KeepsStampsOfTumFiles) {
  const auto list = read_pose_list("1403636579.763555584 1 2 3 0 0 0 1\n1.403636580e+09 4 5 6 0 0 0 1\n", "p");
  ASSERT_TRUE(list) << to_string(list.error());
  EXPECT_EQ(list->T_world_cloud.at(1).translation_m(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(stamps_ns_of(*list), (std::vector<std::int64_t>{1403636579763555584, 1403636580000000000}));
  const auto negative = read_pose_list("-1 1 2 3 0 0 0 1\n", "p");
  ASSERT_TRUE(negative);
  EXPECT_FALSE(stamps_ns_of(*negative));
}

TEST(PoseList, TakesAHeadingFromACommentIfItFits) {
  // EuRoC's order: the quaternion's real part first. Read as TUM it would be another rotation.
  const std::string row = "1403636579763555584,1,2,3,1,0,0,0\n";
  const auto euroc = read_pose_list(
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n" + row,
      "p");
  ASSERT_TRUE(euroc) << to_string(euroc.error());
  EXPECT_EQ(euroc->layout, PoseLayout::kTable);
  EXPECT_NEAR(euroc->T_world_cloud.at(0).angle_rad(), 0.0, 1e-12);
  EXPECT_EQ(stamps_ns_of(*euroc)->at(0), 1403636579763555584);
  const auto tum = read_pose_list("# x y z qx qy qz qw\n0 1 2 3 1 0 0 0\n", "p");
  ASSERT_TRUE(tum) << to_string(tum.error());
  EXPECT_EQ(tum->layout, PoseLayout::kTum);
}

TEST(PoseList, TakesAHeadingFromAnyCommentHoweverItIsCut) {
  const std::string blanks = "40.5 1 2 3 1 0 0 0\n";
  const std::string commas = "40.5,1,2,3,1,0,0,0\n";
  for (const std::string& text :
       {"#timestamp tx ty tz qw qx qy qz\n# frame: map\n" + blanks, "#timestamp,tx,ty,tz,qw,qx,qy,qz\n" + blanks,
        "#timestamp;tx;ty;tz;qw;qx;qy;qz\n" + blanks, "# timestamp tx ty tz qw qx qy qz\n" + commas,
        "# one line each\n# format: timestamp tx ty tz qw qx qy qz\n" + blanks}) {
    const auto list = read_pose_list(text, "p");
    ASSERT_TRUE(list) << text << to_string(list.error());
    EXPECT_EQ(list->layout, PoseLayout::kTable) << text;
    EXPECT_NEAR(list->T_world_cloud.at(0).angle_rad(), 0.0, 1e-12) << text;
    EXPECT_EQ(stamps_ns_of(*list)->at(0), 40'500'000'000) << text;
  }
}

TEST(PoseList, KeepsIdsOfGraphs) {
  const auto list =
      read_pose_list("VERTEX_SE3:QUAT 5 1 0 0 0 0 0 1\nVERTEX_SE3:QUAT 3 2 0 0 0 0 0 1\nEDGE_SE3:QUAT 3 5\n", "p");
  ASSERT_TRUE(list) << to_string(list.error());
  EXPECT_EQ(list->ids, (std::vector<std::uint64_t>{3, 5}));
  EXPECT_EQ(list->T_world_cloud.at(0).translation_m().x(), 2.0);
  EXPECT_FALSE(stamps_ns_of(*list));
}

TEST(PoseList, SaysWhatIsWrongWithWhatItIsNot) {
  EXPECT_EQ(read_pose_list("", "p").error().code, ErrorCode::kEmptyInput);
  EXPECT_EQ(read_pose_list("1 2 3\n", "p").error().message, "expected 8 or 12 columns, found 3");
  EXPECT_EQ(read_pose_list("FIX 0\n", "p").error().code, ErrorCode::kEmptyInput);
  EXPECT_EQ(read_pose_list(std::string_view("\xFF\xFE"
                                            "0\0 \0"
                                            "1\0",
                                            8),
                           "p")
                .error()
                .hint,
            "save it as UTF-8");
  EXPECT_EQ(read_pose_list("1 0 0 0 0 1 0 0 0 0 1 0\n0\n", "p").error().where, "p:2");
  EXPECT_EQ(read_pose_list("x,y,z,qx,qy,qz,qw\n1\n", "p").error().where, "p:2");
  const Error angles = read_pose_list("t,x,y,z,roll,pitch,yaw\n", "p").error();
  EXPECT_EQ(angles.where, "p:1");
  EXPECT_EQ(angles.message, "the heading names no column for qx, qy, qz, qw: \"t,x,y,z,roll,pitch,yaw\"");
}

}  // namespace
}  // namespace kilter
