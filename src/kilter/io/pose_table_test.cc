// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_table.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

void expect_error(std::string_view text, ErrorCode code, const std::string& message_part) {
  const auto table = read_pose_table(text, "poses.csv");
  ASSERT_FALSE(table) << text;
  EXPECT_EQ(error_code_name(table.error().code), error_code_name(code)) << to_string(table.error());
  EXPECT_NE(to_string(table.error()).find(message_part), std::string::npos) << to_string(table.error());
}

// A pose at (1, 2, 3), turned by 90 degrees about z.
void expect_the_pose(const Expected<PoseTable>& table) {
  ASSERT_TRUE(table) << to_string(table.error());
  ASSERT_EQ(table->T_world_cloud.size(), 1U);
  EXPECT_EQ(table->T_world_cloud[0].translation_m(), Eigen::Vector3d(1, 2, 3));
  const Eigen::Vector3d moved = table->T_world_cloud[0].rotation() * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((moved - Eigen::Vector3d(0, 1, 0)).norm(), 1e-6);
}

TEST(PoseTable, GoesByTheNamesOfColumns) {
  const char* const row_first = "0.70710678,0,0,0.70710678,1,2,3\n";
  for (const char* heading :
       {"qw,qx,qy,qz,x,y,z\n", "q_w, q_x, q_y, q_z, tx, ty, tz\r\n", "QW,QX,QY,QZ,X,Y,Z\n",
        "\"qw\",\"qx\",\"qy\",\"qz\",\"px\",\"py\",\"pz\"\n",
        "orientation.w,orientation.x,orientation.y,orientation.z,position.x,position.y,position.z\n",
        "\xEF\xBB\xBF#q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]\n",
        "quat_w,quat_x,quat_y,quat_z,pos_x,pos_y,pos_z\n"}) {
    SCOPED_TRACE(heading);
    expect_the_pose(read_pose_table(std::string(heading) + row_first, "p"));
  }
}

TEST(PoseTable, TakesAnySeparator) {
  const std::string heading = "x y z qx qy qz qw";
  const std::string row = "1 2 3 0 0 0.70710678 0.70710678";
  for (const char separator : {' ', ',', ';', '\t'}) {
    std::string text = "# made by hand\n\n" + heading + "\n" + row + "\n# the end\n";
    std::replace(text.begin() + 15, text.end() - 10, ' ', separator);
    SCOPED_TRACE(text);
    expect_the_pose(read_pose_table(text, "p"));
  }
}

TEST(PoseTable, KeepsStampsUnitsAndNamesOfFiles) {
  const auto table = read_pose_table(
      "%time,field.header.seq,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
      "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w,file\n"
      "1403636579763555584,1,1,2,3,0,0,0.70710678,0.70710678,../../etc/000007.pcd\n",
      "p");
  expect_the_pose(table);
  EXPECT_EQ(table->stamps.at(0).whole, 1403636579763555584);
  EXPECT_FALSE(table->unit);
  EXPECT_EQ(table->files.at(0), "000007.pcd");
  for (const char* name : {"timestamp [ns]", "stamp_ns", "time_nsec", "t (ns)"}) {
    const auto columns = parse_heading(std::string(name) + ",x,y,z,qx,qy,qz,qw");
    ASSERT_TRUE(columns) << name;
    EXPECT_EQ(columns->stamp, 0U) << name;
    EXPECT_EQ(columns->unit, StampUnit::kNanoseconds) << name;
  }
  EXPECT_EQ(parse_heading("time_s,x,y,z,qx,qy,qz,qw")->unit, StampUnit::kSeconds);
  EXPECT_EQ(parse_heading("t [us],x,y,z,qx,qy,qz,qw")->unit, StampUnit::kMicroseconds);
}

TEST(PoseTable, PutsAStampOfTwoColumnsTogether) {
  for (const char* names :
       {"secs,nsecs", "sec,nanosec", "stamp_sec,stamp_nsec", "header.stamp.secs,header.stamp.nsecs"}) {
    const auto table = read_pose_table(std::string(names) + ",x,y,z,qx,qy,qz,qw\n17,5000000,1,2,3,0,0,0,1\n", "p");
    ASSERT_TRUE(table) << names;
    ASSERT_EQ(table->stamps.size(), 1U) << names;
    EXPECT_EQ(table->stamps[0].whole, 17) << names;
    EXPECT_EQ(table->stamps[0].billionths, 5'000'000) << names;
    EXPECT_EQ(table->unit, StampUnit::kSeconds) << names;
  }
  expect_error("secs,nsecs,x,y,z,qx,qy,qz,qw\n17,1000000000,1,2,3,0,0,0,1\n", ErrorCode::kParse,
               "poses.csv:2: column 2: expected nanoseconds below 1000000000, found \"1000000000\"");
  EXPECT_FALSE(parse_heading("a_sec,b_nsec,x,y,z,qx,qy,qz,qw")->nanoseconds) << "of two different stamps";
}

TEST(PoseTable, PassesOverOtherColumnsAndEmptyOnesAtTheEnd) {
  expect_the_pose(read_pose_table("x,y,z,qx,qy,qz,qw,v_x,comment,\n1,2,3,0,0,.70710678,.70710678,9,good,\n", "p"));
}

TEST(PoseTable, SaysWhichColumnsAreMissingOrTwice) {
  expect_error("t,x,y,z,roll,pitch,yaw\n", ErrorCode::kParse,
               "poses.csv:1: the heading names no column for qx, qy, qz, qw: \"t,x,y,z,roll,pitch,yaw\"");
  expect_error("x,y,z,qx,qy,qz,qw,tx\n", ErrorCode::kParse, "columns 1 and 8 of the heading both mean x");
}

TEST(PoseTable, NamesLineColumnExpectedAndFound) {
  const std::string heading = "t,x,y,z,qx,qy,qz,qw\n";
  expect_error(heading + "0,1,2,3,0,0,0\n", ErrorCode::kParse,
               "poses.csv:2: expected 8 columns as in the heading, found 7");
  expect_error(heading + "0,1,2,z\x1B,0,0,0,1\n", ErrorCode::kParse, "column 4 (z): expected a number, found \"z?\"");
  expect_error(heading + "0,1,,3,0,0,0,1\n", ErrorCode::kParse, "column 3 (y): expected a number, found \"\"");
  expect_error(heading + "-1,1,2,3,0,0,0,1\n", ErrorCode::kParse, "column 1: expected a stamp, found \"-1\"");
  expect_error(heading + "0,1,2,3,0,0,0,nan\n", ErrorCode::kInvalidPose, "poses.csv:2: column 8 is nan");
  expect_error(heading + "0,1,2,3,0,0,0,0\n", ErrorCode::kInvalidPose, "length 0");
  expect_error(heading + "0,1e9,2,3,0,0,0,1\n", ErrorCode::kInvalidPose, "farther than");
  expect_error(heading, ErrorCode::kEmptyInput, "holds no pose");
  expect_error("", ErrorCode::kEmptyInput, "holds no pose");
}

}  // namespace
}  // namespace kilter
