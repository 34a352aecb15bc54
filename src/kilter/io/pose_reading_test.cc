// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/io/other_readings.h"

namespace kilter {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

Eigen::Quaterniond yaw(double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
}

// Round rooms, half a metre at a time, turning a quarter to the left or to the right at each corner.
std::vector<Pose3> round_the_corners(double from_x_m = 0.0) {
  std::vector<Pose3> poses;
  Eigen::Vector3d at_m(from_x_m, 0.0, 0.0);
  double heading_rad = 0.0;
  const auto ahead = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      poses.emplace_back(yaw(heading_rad), at_m);
      at_m += yaw(heading_rad) * Eigen::Vector3d(0.5, 0.0, 0.0);
    }
  };
  const auto turn = [&](double by_rad) {
    for (int i = 0; i < 3; ++i) {
      heading_rad += by_rad / 4;
      poses.emplace_back(yaw(heading_rad), at_m);
    }
    heading_rad += by_rad / 4;
  };
  for (const auto& [steps, by_rad] :
       {std::pair(24, kQuarter), {28, kQuarter}, {16, -kQuarter}, {20, kQuarter}, {16, kQuarter}, {28, kQuarter}}) {
    ahead(steps);
    turn(by_rad);
  }
  return poses;
}

// Leaning posts in a hall with boxes on the floor, of which a cloud shows those within 8 m, and the floor round the
// sensor.
RobotLog log_of(const std::vector<Pose3>& truth) {
  RobotLog log;
  log.name = "a";
  log.T_world_cloud = truth;
  log.read_cloud = [truth](std::size_t scan) -> Expected<PointCloud> {
    PointCloud cloud;
    Rng rng(7, 0);
    const auto add = [&](const Eigen::Vector3d& world_m) {
      const Eigen::Vector3f at_m = (truth[scan].inverse() * world_m).cast<float>();
      cloud.add(at_m.x(), at_m.y(), at_m.z());
    };
    for (int post = 0; post < 600; ++post) {
      const Eigen::Vector3d foot_m(rng.uniform(-12.0, 34.0), rng.uniform(-12.0, 34.0), rng.uniform(-1.5, 0.5));
      if ((foot_m - truth[scan].translation_m()).norm() > 8.0) continue;
      for (int i = 0; i < 25; ++i) add(foot_m + 0.1 * i * Eigen::Vector3d(0.3, 0.0, 1.0));
    }
    for (int i = 0; i < 700; ++i) {
      cloud.add(4.0F * std::cos(0.009F * static_cast<float>(i)), 4.0F * std::sin(0.009F * static_cast<float>(i)),
                -1.0F);
    }
    return cloud;
  };
  return log;
}

using Change = std::function<Pose3(const std::vector<Pose3>&, std::size_t)>;

std::optional<OtherReading> read_after(const Change& change) {
  const std::vector<Pose3> truth = round_the_corners();
  RobotLog log = log_of(truth);
  for (std::size_t i = 0; i < truth.size(); ++i) log.T_world_cloud[i] = change(truth, i);
  return find_other_reading(std::array{log}, 0);
}

void expect_reading(PoseReading reading, const std::string& how, const Change& change) {
  const auto found = read_after(change);
  ASSERT_TRUE(found) << how;
  EXPECT_EQ(found->reading, reading) << how << " is " << found->how;
  EXPECT_NE(found->how.find(how), std::string::npos) << found->how;
  EXPECT_GT(found->otherwise, 1.2 * found->as_given) << how;
}

TEST(FindOtherReading, SaysNothingOfPosesAsTheyAre) {
  EXPECT_FALSE(read_after([](const auto& truth, std::size_t i) { return truth[i]; }));
  EXPECT_FALSE(read_after([](const auto& truth, std::size_t i) {
    return Pose3(yaw(0.01), {3.0, 4.0, 5.0}) * truth[i] * Pose3(yaw(0.01), {0.02, 0.01, 0.0});
  })) << "another world frame, and a mounting known to half a degree";
}

TEST(FindOtherReading, NamesWhatWasDoneToPoses) {
  expect_reading(PoseReading::kInverse, "inverted",
                 [](const auto& truth, std::size_t i) { return truth[i].inverse(); });
  expect_reading(PoseReading::kTransposed, "transposed rotations", [](const auto& truth, std::size_t i) {
    return Pose3(truth[i].rotation().conjugate(), truth[i].translation_m());
  });
  expect_reading(PoseReading::kScalarFirst, "qw qx qy qz", [](const auto& truth, std::size_t i) {
    const Eigen::Quaterniond& q = truth[i].rotation();
    return Pose3(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), truth[i].translation_m());
  });
  expect_reading(PoseReading::kShifted, "5 clouds before",
                 [](const auto& truth, std::size_t i) { return truth[std::min(i + 5, truth.size() - 1)]; });
  expect_reading(PoseReading::kShifted, "1 cloud later",
                 [](const auto& truth, std::size_t i) { return truth[i > 0 ? i - 1 : 0]; });
}

TEST(FindOtherReading, NamesAxes) {
  const Eigen::Matrix3d over_y = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  const auto mirrored = [&](const auto& truth, std::size_t i) { return with_axes(truth[i], over_y); };
  expect_reading(PoseReading::kMirrored, "axes read as (x, -y, z)", mirrored);
  // A sensor on its head is the same to a robot that stays level.
  expect_reading(PoseReading::kMirrored, "or with their sensor turned by 180 degrees about x", mirrored);
  Eigen::Matrix3d exchanged;
  exchanged << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  expect_reading(PoseReading::kMirrored, "axes read as (y, x, z)",
                 [&](const auto& truth, std::size_t i) { return with_axes(truth[i], exchanged); });
  expect_reading(PoseReading::kOtherAxes, "positions read as (x, -y, z)", [&](const auto& truth, std::size_t i) {
    return Pose3(truth[i].rotation(), over_y * truth[i].translation_m());
  });
}

TEST(FindOtherReading, TellsHowASensorIsMounted) {
  for (const double angle_rad : {kQuarter, std::numbers::pi, -0.6, 0.15}) {
    const auto found = read_after([&](const auto& truth, std::size_t i) {
      return Pose3(truth[i].rotation() * yaw(angle_rad).conjugate(), truth[i].translation_m());
    });
    ASSERT_TRUE(found) << angle_rad;
    ASSERT_EQ(found->reading, PoseReading::kTurned) << angle_rad << " " << found->how;
    const std::string quaternion = found->how.substr(found->how.find("qw: ") + 4);
    Eigen::Quaterniond told;
    ASSERT_EQ(std::sscanf(quaternion.c_str(), "%lf %lf %lf %lf", &told.x(), &told.y(), &told.z(), &told.w()), 4);
    EXPECT_LT(told.angularDistance(yaw(angle_rad)), 0.04) << angle_rad << " " << found->how;
  }
  // A lidar that leans forward by 40 degrees and looks to its left.
  const Eigen::Quaterniond leaning = yaw(kQuarter) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY());
  const auto found = read_after([&](const auto& truth, std::size_t i) {
    return Pose3(truth[i].rotation() * leaning.conjugate(), truth[i].translation_m());
  });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->reading, PoseReading::kTurned) << found->how << found->as_given << " " << found->otherwise;
}

TEST(FindOtherReading, NamesTheRobotWhosePosesTheyAre) {
  const std::vector<Pose3> one = round_the_corners();
  std::vector<Pose3> other = one;
  std::reverse(other.begin(), other.end());
  std::array robots = {log_of(one), log_of(other)};
  robots[1].name = "b";
  EXPECT_FALSE(find_other_reading(robots, 0));
  EXPECT_FALSE(find_other_reading(robots, 1));
  std::swap(robots[0].T_world_cloud, robots[1].T_world_cloud);
  for (const std::size_t place : {0U, 1U}) {
    const auto found = find_other_reading(robots, place);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->reading, PoseReading::kOtherRobot) << found->how;
    EXPECT_EQ(found->how, place == 0 ? "under the poses of b" : "under the poses of a");
  }
  // One that stands still puts all clouds in one place, where the rings on the floor meet.
  robots[0] = log_of(one);
  for (Pose3& T : robots[1].T_world_cloud) T = Pose3();
  EXPECT_FALSE(find_other_reading(robots, 0));
}

TEST(FindOtherReading, LooksAtCloudsFarApartWhereThereAreNoOthers) {
  const std::vector<Pose3> all = round_the_corners();
  std::vector<Pose3> few;
  for (std::size_t i = 0; i < all.size(); i += 10) few.push_back(all[i]);
  RobotLog log = log_of(few);
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
  for (Pose3& T : log.T_world_cloud) T = Pose3(T.rotation().conjugate(), T.translation_m());
  const auto found = find_other_reading(std::array{log}, 0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->reading, PoseReading::kTransposed) << found->how;
}

// An aisle whose walls drift sideways by 10 cm a metre: kept parallel they fit better, and no reading is right.
TEST(FindOtherReading, TakesAMapThatIsBentForNoOtherReading) {
  std::vector<Pose3> truth;
  for (int i = 0; i < 40; ++i) truth.push_back(Pose3::from_translation(0.5 * i, 0.0, 1.0));
  RobotLog log = log_of(truth);
  log.read_cloud = [truth](std::size_t scan) -> Expected<PointCloud> {
    PointCloud cloud;
    for (int i = 0; i < 2400; ++i) {
      const Eigen::Vector3d at_m(truth[scan].translation_m().x() + 0.01 * (i % 1200) - 6.0, i < 1200 ? 1.5 : -1.5,
                                 0.1 * (i % 25));
      const Eigen::Vector3f seen_m = (truth[scan].inverse() * at_m).cast<float>();
      cloud.add(seen_m.x(), seen_m.y(), seen_m.z());
    }
    return cloud;
  };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    log.T_world_cloud[i] = Pose3::from_translation(0.5 * static_cast<double>(i), 0.1 * static_cast<double>(i), 1.0);
  }
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
}

// All z are 0, on a border of cells, and the poses go down by less than any sensor knows.
TEST(FindOtherReading, LosesNoSurfaceOnABorderOfCells) {
  const std::vector<Pose3> truth = round_the_corners();
  RobotLog log = log_of(truth);
  const auto solid = log.read_cloud;
  log.read_cloud = [solid](std::size_t i) -> Expected<PointCloud> {
    PointCloud flat;
    const Expected<PointCloud> cloud = solid(i);
    for (const Eigen::Vector3f& point_m : cloud->points_m) flat.add(point_m.x(), point_m.y(), 0.0F);
    return flat;
  };
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    log.T_world_cloud[i] = Pose3::from_translation(0.0, 0.0, -1e-9 * static_cast<double>(i)) * truth[i];
  }
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
}

TEST(FindOtherReading, SaysThatNoneFits) {
  const auto found = read_after([](const auto& truth, std::size_t i) {
    Rng rng(3, i);
    return Pose3(yaw(rng.uniform(-3.0, 3.0)),
                 truth[i].translation_m() + rng.uniform(-2.0, 2.0) * Eigen::Vector3d::UnitZ());
  });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->reading, PoseReading::kNeither);
  EXPECT_TRUE(found->how.empty());
}

TEST(FindOtherReading, IsSilentWithoutClouds) {
  RobotLog log = log_of(round_the_corners());
  log.read_cloud = [](std::size_t) -> Expected<PointCloud> { return fail(ErrorCode::kNotFound, "gone", {}, "look"); };
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
  log.read_cloud = nullptr;
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
  log = log_of({Pose3()});
  EXPECT_FALSE(find_other_reading(std::array{log}, 0));
}

}  // namespace
}  // namespace kilter
