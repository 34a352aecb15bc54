// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_log.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "kilter/io/bags/mcap.h"
#include "kilter/io/bags/rosbag1.h"
#include "kilter/io/mission.h"
#include "testing/bag_walk.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::at_x;
using kilter_testing::mcap_bytes;
using kilter_testing::RecordedMessage;
using kilter_testing::RosDialect;
using kilter_testing::small_drive;
using testing::Contains;
using testing::HasSubstr;

constexpr RosDialect kCdr = RosDialect::kCdrLittle;
const MissionOptions kGlance = {.poses_folder = {}, .T_body_sensor = {}, .glance = true};
constexpr std::int64_t kTenth = 100'000'000;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000;

// Opens a recording as `kilter check run.mcap#...` does.
Expected<Mission> open_recording(const std::vector<RecordedMessage>& messages, const std::string& topics = "") {
  const kilter_testing::TempFolder folder;
  const auto file = folder.write("run.mcap", mcap_bytes(messages));
  return open_mission({file.string() + topics});
}

RecordedMessage cloud(int i, const std::string& topic = "/points", const std::string& frame = "lidar") {
  const std::int64_t stamp_ns = kStart + kTenth * i;
  return {topic, "sensor_msgs/PointCloud2", stamp_ns, kilter_testing::cloud_message(kCdr, stamp_ns, frame, 2)};
}

RecordedMessage odometry(int i, double x, const std::string& topic = "/odom", const std::string& child = "lidar") {
  const std::int64_t stamp_ns = kStart + kTenth * i;
  return {topic, "nav_msgs/Odometry", stamp_ns,
          kilter_testing::odometry_message(kCdr, stamp_ns, "odom", child, at_x(x))};
}

double x_of(const Mission& mission, std::size_t i) { return mission.robots[0].T_world_cloud[i].translation_m().x(); }

Expected<RobotLog> log_within(UnpackingBudget budget, std::unique_ptr<BagReader> reader,
                              std::vector<std::string>& notes) {
  BagFiles files;
  files.push_back(std::move(reader));
  return make_bag_log("a", std::move(files), {}, "run", notes, budget);
}

// So many points of a byte for each coordinate, all the same.
RecordedMessage equal_points(std::uint32_t points) {
  kilter_testing::RosBytes bytes(kCdr);
  bytes.header(kStart, "lidar").number(std::uint32_t{1}).number(points).number(std::uint32_t{3});
  for (std::uint32_t i = 0; i < 3; ++i) {
    bytes.text(std::string(1, static_cast<char>('x' + i))).number(i).number(std::uint8_t{1}).number(std::uint32_t{1});
  }
  bytes.number(std::uint8_t{0}).number(std::uint32_t{3}).number(3 * points).number(3 * points);
  bytes.raw(std::string(std::size_t{3} * points, '\5')).number(std::uint8_t{1});
  return {"/points", "sensor_msgs/PointCloud2", kStart, bytes.str()};
}

TEST(BagLog, RefusesMorePointsThanPackedBytesJustify) {
  using kilter_testing::BagPacking;
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kLz4}) {
    for (const std::uint32_t points : {1U << 20, (1U << 20) + 1}) {
      const bool is_refused = packing != BagPacking::kNone && points > 1U << 20;
      const std::string mcap = mcap_bytes({odometry(0, 0.0), equal_points(points)}, {.packing = packing});
      std::vector<std::string> notes;
      const auto log = log_within({}, open_mcap(RandomAccessFile::over(mcap, "run")).value(), notes);
      ASSERT_TRUE(log) << to_string(log.error());
      const auto read = log->read_cloud(0);
      ASSERT_EQ(read.has_value(), !is_refused);
      if (!is_refused) continue;
      EXPECT_EQ(read.error().code, ErrorCode::kUnsupported);
      EXPECT_THAT(read.error().message, HasSubstr("claim to hold 1048577 points"));
    }
  }
}

TEST(BagLog, CountsWhatItHasNoBudgetToUnpack) {
  // Chunks of two messages, one cloud in three; the first chunk is always read.
  const std::string bag = rosbag1_bytes(small_drive(RosDialect::kRos1, 6),
                                        {.packing = kilter_testing::BagPacking::kBz2, .messages_per_chunk = 5});
  const std::string mcap =
      mcap_bytes(small_drive(kCdr, 6), {.packing = kilter_testing::BagPacking::kZstd, .messages_per_chunk = 5});
  for (const bool is_mcap : {false, true}) {
    SCOPED_TRACE(is_mcap);
    const auto open = [&] {
      return is_mcap ? open_mcap(RandomAccessFile::over(mcap, "run")).value()
                     : open_rosbag1(RandomAccessFile::over(bag, "run")).value();
    };
    std::vector<std::string> notes;
    const auto whole = log_within({}, open(), notes);
    ASSERT_TRUE(whole) << to_string(whole.error());
    EXPECT_EQ(whole->clouds_found, 6U);
    EXPECT_EQ(whole->clouds_unread, 0U);
    EXPECT_THAT(notes, testing::Not(Contains(HasSubstr("looked at"))));
    const auto glance = log_within(UnpackingBudget(1), open(), notes);
    ASSERT_TRUE(glance) << to_string(glance.error());
    EXPECT_EQ(glance->clouds_found, 1U);
    EXPECT_EQ(glance->clouds_unread, 5U);
    EXPECT_EQ(glance->T_world_cloud.front().translation_m(), whole->T_world_cloud.front().translation_m());
    EXPECT_THAT(notes, Contains(HasSubstr("only the first 1 of 6 clouds were looked at")));
  }
}

TEST(BagLog, ReadsAllWhereNoIndexTellsWhatIsPassedOver) {
  std::vector<std::string> notes;
  const std::string bag =
      rosbag1_bytes(small_drive(RosDialect::kRos1, 6),
                    {.packing = kilter_testing::BagPacking::kBz2, .messages_per_chunk = 5, .is_closed = false});
  // What follows the last chunk of a bag that was never closed cannot be told from an index that was cut off.
  const auto glance = log_within(UnpackingBudget(1), open_rosbag1(RandomAccessFile::over(bag, "run")).value(), notes);
  ASSERT_FALSE(glance);
  EXPECT_EQ(glance.error().code, ErrorCode::kUnsupported);
  const kilter_testing::TempFolder folder;
  const auto mission = open_mission({folder.write("run.bag", bag)}, kGlance);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->robots[0].clouds_found, 6U);
  EXPECT_EQ(mission->robots[0].clouds_unread, 0U);
}

TEST(BagLog, LooksFurtherWhereTheBeginningOfABagIsNotEnough) {
  // Only the last chunk has poses.
  auto messages = small_drive(RosDialect::kRos1, 4);
  std::stable_partition(messages.begin(), messages.end(),
                        [](const RecordedMessage& message) { return message.topic != "/odom"; });
  const kilter_testing::TempFolder folder;
  const std::string bag =
      rosbag1_bytes(messages, {.packing = kilter_testing::BagPacking::kBz2, .messages_per_chunk = 3});
  std::vector<std::string> notes;
  const auto glance = log_within(UnpackingBudget(1), open_rosbag1(RandomAccessFile::over(bag, "run")).value(), notes);
  ASSERT_FALSE(glance);
  const auto mission = open_mission({folder.write("run.bag", bag)}, kGlance);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->robots[0].clouds_found, 4U);
}

TEST(BagLog, ReadsTheSameFromEveryKindOfBag) {
  const kilter_testing::TempFolder folder;
  static_cast<void>(folder.write("a.bag", rosbag1_bytes(small_drive(RosDialect::kRos1))));
  static_cast<void>(folder.write("b.mcap", mcap_bytes(small_drive(RosDialect::kCdrBig))));
  static_cast<void>(folder.write("c/metadata.yaml", ""));
  kilter_testing::write_sqlite_bag(folder.path() / "c/run_0.db3", small_drive(kCdr, 2));
  const std::vector<std::string> kinds = {"ROS 1 bag", "ROS 2 bag (MCAP)", "ROS 2 bag (sqlite3)"};
  const auto mission =
      open_mission({folder.path() / "a.bag", folder.path() / "b.mcap", "c=" + (folder.path() / "c").string()});
  ASSERT_TRUE(mission) << to_string(mission.error());
  for (std::size_t r = 0; r < 3; ++r) {
    const RobotLog& log = mission->robots[r];
    EXPECT_EQ(log.kind, kinds[r]);
    ASSERT_EQ(log.T_world_cloud.size(), r == 2 ? 2U : 4U);
    for (std::size_t i = 0; i < log.T_world_cloud.size(); ++i) {
      EXPECT_EQ(log.T_world_cloud[i].translation_m().x(), static_cast<double>(i));
      EXPECT_EQ(log.stamps_ns[i], kStart + kTenth * static_cast<std::int64_t>(i));
      const auto points = log.read_cloud(i);
      ASSERT_TRUE(points) << to_string(points.error());
      EXPECT_EQ(points->points_m.at(0), Eigen::Vector3f(static_cast<float>(i), 2, 3));
      EXPECT_EQ(log.peek_cloud(i)->points, points->points_m.size());
    }
  }
}

TEST(BagLog, ReadsCloudsForSeveralThreadsAtOnce) {
  const kilter_testing::TempFolder folder;
  constexpr int kClouds = 40;
  static_cast<void>(folder.write(
      "a.bag", rosbag1_bytes(small_drive(RosDialect::kRos1, kClouds), {.packing = kilter_testing::BagPacking::kLz4})));
  kilter_testing::write_sqlite_bag(folder.path() / "b.db3", small_drive(kCdr, kClouds));
  const auto mission = open_mission({folder.path() / "a.bag", folder.path() / "b.db3"});
  ASSERT_TRUE(mission) << to_string(mission.error());
  std::atomic<int> right{0};
  const auto read_all = [&](int first) {
    for (const RobotLog& log : mission->robots) {
      for (int k = 0; k < kClouds; ++k) {
        const int i = (first + 7 * k) % kClouds;
        const auto points = log.read_cloud(static_cast<std::size_t>(i));
        right += points && points->points_m.at(0).x() == static_cast<float>(i) ? 1 : 0;
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int first = 0; first < 4; ++first) threads.emplace_back(read_all, 10 * first);
  }
  EXPECT_EQ(right, 4 * 2 * kClouds);
}

TEST(BagLog, TakesTheTopicWithMostCloudsUnlessToldOtherwise) {
  std::vector<RecordedMessage> messages;
  for (int i = 0; i < 5; ++i) messages.push_back(odometry(i, i));
  for (int i = 0; i < 5; ++i) messages.push_back(cloud(i));
  for (int i = 0; i < 3; ++i) messages.push_back(cloud(i, "/front"));
  for (int i = 0; i < 5; ++i) messages.push_back(cloud(i, "/map_points", "odom"));
  const auto most = open_recording(messages);
  ASSERT_TRUE(most) << to_string(most.error());
  EXPECT_EQ(most->robots[0].clouds_found, 5U);
  EXPECT_THAT(most->notes, Contains(HasSubstr("/points (sensor_msgs/PointCloud2), frame lidar; not from /front (3)")));
  const auto named = open_recording(messages, "#/front");
  ASSERT_TRUE(named) << to_string(named.error());
  EXPECT_EQ(named->robots[0].clouds_found, 3U);
  const auto unknown = open_recording(messages, "#/back");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(unknown.error().message, HasSubstr("/odom (nav_msgs/msg/Odometry, 5 messages)"));
}

TEST(BagLog, InterpolatesAndLeavesOutCloudsWithoutAPose) {
  std::vector<RecordedMessage> messages = {odometry(0, 0), odometry(2, 20), odometry(12, 30)};
  for (const int i : {0, 1, 5, 12}) messages.push_back(cloud(i));
  const auto mission = open_recording(messages);
  ASSERT_TRUE(mission) << to_string(mission.error());
  ASSERT_EQ(mission->robots[0].T_world_cloud.size(), 3U);
  EXPECT_NEAR(x_of(*mission, 1), 10.0, 1e-12);
  EXPECT_EQ(x_of(*mission, 2), 30.0);
  EXPECT_EQ(mission->robots[0].clouds_found, 4U);
  EXPECT_EQ(mission->robots[0].poses_found, 3U);
  EXPECT_THAT(mission->notes, Contains(HasSubstr("poses matched 3 of 4 clouds")));
}

TEST(BagLog, AsksOdometryBeforePosesBeforePathsBeforeTransforms) {
  std::vector<RecordedMessage> messages;
  std::vector<kilter_testing::TimedPose> path;
  for (int i = 0; i < 4; ++i) {
    const std::int64_t stamp_ns = kStart + kTenth * i;
    messages.push_back(cloud(i));
    messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp_ns,
                        kilter_testing::transforms_message(kCdr, {{stamp_ns, "map", "lidar", at_x(4000 + i)}})});
    path.push_back({stamp_ns, at_x(3000 + i)});
    messages.push_back({"/path", "nav_msgs/Path", stamp_ns, kilter_testing::path_message(kCdr, "map", path)});
    messages.push_back({"/pose", "geometry_msgs/PoseStamped", stamp_ns,
                        kilter_testing::pose_message(kCdr, stamp_ns, "map", at_x(2000 + i))});
    messages.push_back(odometry(i, 1000 + i));
  }
  for (const double expected : {1000.0, 2000.0, 3000.0, 4000.0}) {
    const auto mission = open_recording(messages);
    ASSERT_TRUE(mission) << to_string(mission.error());
    EXPECT_EQ(x_of(*mission, 0), expected);
    EXPECT_EQ(x_of(*mission, 3), expected + 3);
    std::erase_if(messages, [&](const RecordedMessage& message) {
      return message.topic == (expected == 1000 ? "/odom" : expected == 2000 ? "/pose" : "/path");
    });
  }
  const auto named = open_recording(small_drive(kCdr), "#/points#/odom");
  EXPECT_TRUE(named) << to_string(named.error());
}

TEST(BagLog, PrefersTheOdometryThatWasStampedWithTheClouds) {
  std::vector<RecordedMessage> messages;
  for (int i = 0; i < 4; ++i) messages.push_back(cloud(i));
  for (int i = 0; i < 40; ++i) {
    const std::int64_t stamp_ns = kStart + kTenth / 10 * i - 3'000'000;
    messages.push_back({"/imu_odom", "nav_msgs/Odometry", stamp_ns,
                        kilter_testing::odometry_message(kCdr, stamp_ns, "odom", "lidar", at_x(-1))});
  }
  for (int i = 0; i < 4; ++i) messages.push_back(odometry(i, i, "/mapping_odom"));
  EXPECT_EQ(x_of(*open_recording(messages), 3), 3.0);
}

TEST(BagLog, DoesNotTakeAGoalForATrajectory) {
  std::vector<RecordedMessage> messages;
  for (int i = 0; i < 4; ++i) {
    const std::int64_t stamp_ns = kStart + kTenth * i;
    messages.push_back(cloud(i));
    messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp_ns,
                        kilter_testing::transforms_message(kCdr, {{stamp_ns, "map", "lidar", at_x(i)}})});
  }
  messages.push_back(
      {"/goal", "geometry_msgs/PoseStamped", kStart, kilter_testing::pose_message(kCdr, kStart, "map", at_x(77))});
  const auto mission = open_recording(messages);
  ASSERT_TRUE(mission) << to_string(mission.error());
  ASSERT_EQ(mission->robots[0].T_world_cloud.size(), 4U);
  EXPECT_EQ(x_of(*mission, 3), 3.0);
}

TEST(BagLog, MovesPosesOfTheVehicleByStaticTransforms) {
  std::vector<RecordedMessage> messages = {cloud(0), cloud(1), odometry(0, 0, "/odom", "base"),
                                           odometry(1, 1, "/odom", "base")};
  const auto without = open_recording(messages);
  ASSERT_TRUE(without);
  EXPECT_EQ(x_of(*without, 1), 1.0);
  EXPECT_THAT(without->notes, Contains(HasSubstr("no static transform joins them")));
  messages.push_back({"/tf_static", "tf2_msgs/TFMessage", kStart,
                      kilter_testing::transforms_message(kCdr, {{0, "base", "lidar", at_x(0.25)}})});
  const auto with = open_recording(messages);
  ASSERT_TRUE(with) << to_string(with.error());
  EXPECT_EQ(x_of(*with, 1), 1.25);
  EXPECT_THAT(with->notes, Contains(HasSubstr("moved by the bag's static transforms")));
}

TEST(BagLog, BringsCloudsInTheWorldBackToWhereTheyWereSeen) {
  const auto mission = open_recording({cloud(0, "/points", "odom"), odometry(0, 5)});
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(x_of(*mission, 0), 5.0);
  EXPECT_EQ(mission->robots[0].read_cloud(0)->points_m[0], Eigen::Vector3f(-4, 2, 3));
  EXPECT_THAT(mission->notes, Contains(HasSubstr("brought back")));
}

TEST(BagLog, TakesNoOtherTopicForOneThatIsNamed) {
  const std::vector<RecordedMessage> messages = {cloud(0), odometry(0, 0), odometry(0, std::nan(""), "/broken")};
  EXPECT_TRUE(open_recording(messages, "#/odom"));
  const auto refused = open_recording(messages, "#/broken");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidPose);
  // Clouds of one world, poses of another: neither can be brought to the other.
  EXPECT_EQ(open_recording({cloud(0, "/points", "map"), odometry(0, 0)}).error().code, ErrorCode::kEmptyInput);
}

TEST(BagLog, SaysWhatIsMissing) {
  const auto no_clouds = open_recording({odometry(0, 0)});
  ASSERT_FALSE(no_clouds);
  EXPECT_EQ(no_clouds.error().code, ErrorCode::kEmptyInput);
  EXPECT_THAT(no_clouds.error().message, HasSubstr("/odom (nav_msgs/msg/Odometry, 1 message)"));
  const auto no_poses = open_recording({cloud(0), cloud(1)});
  ASSERT_FALSE(no_poses);
  EXPECT_EQ(no_poses.error().code, ErrorCode::kEmptyInput);
  EXPECT_THAT(no_poses.error().message, HasSubstr("/points (sensor_msgs/msg/PointCloud2, 2 messages)"));
  const auto other_clock = open_recording({cloud(0), cloud(1), odometry(5000, 0), odometry(5001, 0)});
  ASSERT_FALSE(other_clock);
  EXPECT_EQ(other_clock.error().code, ErrorCode::kCountMismatch);
  EXPECT_THAT(other_clock.error().message, HasSubstr("clouds are from 1700000000.000 to 1700000000.100 s"));
  EXPECT_THAT(other_clock.error().message, HasSubstr("from 1700000500.000 to 1700000500.100 s"));
  EXPECT_EQ(open_recording({}).error().code, ErrorCode::kEmptyInput);
}

TEST(BagLog, CountsMessagesThatCannotBeUsed) {
  std::vector<RecordedMessage> messages = {cloud(0), cloud(1), odometry(0, 0), odometry(1, 1)};
  messages.push_back(messages[0]);
  messages.back().bytes.resize(9);
  messages.push_back(odometry(2, std::nan("")));
  const auto mission = open_recording(messages);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_THAT(mission->notes, Contains(HasSubstr("1 messages of /points (sensor_msgs/PointCloud2) could not be used")));
  EXPECT_THAT(mission->notes, Contains(HasSubstr("invalid-pose")));
}

TEST(BagLog, ReadsMessagesPackedOneByOneAndPartsOfARecording) {
  const kilter_testing::TempFolder folder;
  auto messages = small_drive(kCdr);
  for (RecordedMessage& message : messages) message.bytes = kilter_testing::zstd_bytes(message.bytes);
  const auto half = static_cast<std::ptrdiff_t>(messages.size() / 2);
  std::filesystem::create_directories(folder.path() / "run");
  kilter_testing::write_sqlite_bag(folder.path() / "run/run_9.db3", {messages.begin(), messages.begin() + half});
  kilter_testing::write_sqlite_bag(folder.path() / "run/run_10.db3", {messages.begin() + half, messages.end()});
  const auto mission = open_mission({folder.path() / "run"});
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->robots[0].T_world_cloud.size(), 4U);
  EXPECT_EQ(mission->robots[0].read_cloud(3)->points_m.at(0).x(), 3.0F);
  static_cast<void>(folder.write("two/a.mcap", ""));
  static_cast<void>(folder.write("two/b.mcap", ""));
  EXPECT_EQ(open_mission({folder.path() / "two"}).error().code, ErrorCode::kUnsupported);
  const auto packed = open_mission({folder.write("run_0.db3.zstd", "")});
  ASSERT_FALSE(packed);
  EXPECT_THAT(packed.error().hint, HasSubstr("zstd -d"));
}

TEST(BagLog, LeavesAMissionWithABagBesideItsRobotsAMission) {
  const kilter_testing::TempFolder folder;
  static_cast<void>(folder.write("run.mcap", mcap_bytes(small_drive(kCdr))));
  static_cast<void>(folder.write("a/scans/0.bin", ""));
  static_cast<void>(folder.write("a/poses.tum", "0 0 0 0 0 0 0 1\n"));
  const auto mission = open_mission({folder.path()});
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->sources[0].kind, "mission");
}

TEST(BagLog, TellsThatARecordingWasCutWhereSomethingIsMissing) {
  const kilter_testing::TempFolder folder;
  const auto refused = open_mission({folder.write("run.mcap", mcap_bytes(small_drive(kCdr)).substr(0, 100))});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEmptyInput);
  EXPECT_THAT(refused.error().hint, HasSubstr("cut short"));
}

TEST(BagLog, TakesTopicsOfBagsOnly) {
  const kilter_testing::TempFolder folder;
  static_cast<void>(folder.write("robot/scans/0.bin", ""));
  const auto refused = open_mission({(folder.path() / "robot").string() + "#/points"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace kilter
