// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/common_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

// Somewhere in the cell, but not near its borders.
double inside(Rng& rng, int cells) { return kPlace_m * (std::floor(rng.uniform(0.0, cells)) + rng.uniform(0.2, 0.8)); }

TEST(PlacesOf, CountPlacesAndNotHowDenselyTheyWereSeen) {
  std::vector<PlaneResidual> residuals;
  Rng rng(13, 0);
  for (int i = 0; i < 4000; ++i) {  // a square metre near the sensor, half of all residuals, and a strip of 15 m
    const bool dense = i % 2 == 0;
    residuals.push_back({{inside(rng, dense ? 4 : 50), (dense ? 3.0 : 0.0) + inside(rng, dense ? 4 : 1), 0.0},
                         Eigen::Vector3d::UnitZ(),
                         0.01,
                         1.0});
  }
  const std::vector<CommonPlace> places = places_of(residuals, kPlace_m);
  EXPECT_EQ(places.size(), 66U);
  EXPECT_EQ(std::count_if(places.begin(), places.end(), [](const CommonPlace& p) { return p.point_m.y() > 1.0; }), 16);
}

TEST(PlacesOf, AreTheMeanOfWhatWasSeenAndWhen) {
  std::vector<PlaneResidual> residuals(3);
  residuals[0] = {{0.05, 0.1, 0.0}, Eigen::Vector3d::UnitZ(), 0.0, 1.0, 10, 200};
  residuals[1] = {{0.2, 0.1, 0.0}, Eigen::Vector3d::UnitX(), 0.0, 0.1, 30, 255};
  residuals[2] = {{-0.1, 0.1, 0.0}, Eigen::Vector3d::UnitX(), 0.0, 1.0, 255, 0};
  const std::vector<CommonPlace> places = places_of(residuals, kPlace_m);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_NEAR((places[0].point_m - Eigen::Vector3d(0.125, 0.1, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(places[0].source[0], 0.5F);
  EXPECT_EQ(places[0].source[1], 0.5F);
  EXPECT_EQ(places[0].target[11], 0.5F);
  EXPECT_EQ(places[1].source[11], 1.0F);
}

TEST(PlaceEdge, IsNeverSmallBesideVoxels) {
  EXPECT_EQ(place_edge_m({.edge_m = 0.05}), kPlace_m);
  EXPECT_EQ(place_edge_m({.edge_m = 1.0}), 2.0);
}

// What of one submap lies within 2 cm of the other's is in a place with it, unless a border happens to run between.
TEST(CommonPlaces, AreWhereBothShowSomething) {
  const testing::SubmapPair rooms = testing::room_pair();
  const std::vector<CommonPlace> places =
      common_places(rooms.source.map, rooms.target.map, rooms.T_target_source, {}, kPlace_m);
  const auto near_a_place = [&](const Eigen::Vector3d& at_m) {
    return std::any_of(places.begin(), places.end(), [&](const CommonPlace& place) {
      return (place.point_m - at_m).cwiseAbs().maxCoeff() < kPlace_m;
    });
  };
  int close = 0;
  int found = 0;
  for (const Eigen::Vector3f& from_m : rooms.source.map.voxels().centroids_m) {
    const Eigen::Vector3d at_m = rooms.T_target_source * from_m.cast<double>();
    const auto& others_m = rooms.target.map.voxels().centroids_m;
    if (std::none_of(others_m.begin(), others_m.end(),
                     [&](const Eigen::Vector3f& other_m) { return (other_m.cast<double>() - at_m).norm() < 0.02; })) {
      continue;
    }
    ++close;
    found += near_a_place(at_m) ? 1 : 0;
  }
  ASSERT_GT(close, 100);
  EXPECT_GT(found, close * 98 / 100);
  for (const CommonPlace& place : places) {
    EXPECT_NEAR(std::accumulate(place.source.begin(), place.source.end(), 0.0F), 1.0F, 1e-5F);
    EXPECT_NEAR(std::accumulate(place.target.begin(), place.target.end(), 0.0F), 1.0F, 1e-5F);
  }
}

TEST(CommonPlaces, OfNothingAreNone) {
  const testing::SubmapPair rooms = testing::room_pair();
  EXPECT_TRUE(common_places({}, {}, {}, {}, kPlace_m).empty());
  EXPECT_TRUE(common_places(rooms.source.map, {}, {}, {}, kPlace_m).empty());
  EXPECT_TRUE(common_places({}, rooms.target.map, {}, {}, kPlace_m).empty());
}

// A floor of 3 by 3 m, by a point every 5 cm.
VoxelMap floor_at(double z_m) {
  std::vector<Eigen::Vector3d> points;
  for (int x = -30; x < 30; ++x) {
    for (int y = -30; y < 30; ++y) points.emplace_back(0.05 * x + 0.02, 0.05 * y + 0.02, z_m);
  }
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  builder.insert_scan(points, {0.0, 0.0, 0.0});
  return builder.finish();
}

// Six millimetres apart, on either side of where voxels and whole cells from the frame's origin meet.
TEST(CommonPlaces, AFloorOnABorderIsOneFloor) {
  const std::size_t places = common_places(floor_at(-0.897), floor_at(-0.903), {}, {}, kPlace_m).size();
  EXPECT_GE(places, 100U);
  EXPECT_LE(places, 121U);
}

// A wall of 6 by 2 m at x = 3.04, or where a slip has put it, by a point every 5 cm.
std::vector<Eigen::Vector3d> wall_at(double x_m) {
  std::vector<Eigen::Vector3d> points;
  for (int y = -60; y < 60; ++y) {
    for (int z = -20; z < 20; ++z) points.emplace_back(x_m, 0.05 * y + 0.012, 0.05 * z + 0.013);
  }
  return points;
}

// Three scans see a wall, then the source slips by 0.6 m, and a fourth draws it behind once more.
TEST(CommonPlaces, AWallThatASlipDrawsTwiceIsOne) {
  const OccupancyOptions options{.resolution_m = 0.1, .min_range_m = 0.0};
  MapBuilder before(options);
  MapBuilder slipped(options);
  for (int scan = 0; scan < 3; ++scan) {
    before.insert_scan(wall_at(3.04), {0.02, 0.03, 0.04});
    slipped.insert_scan(wall_at(3.04), {0.02, 0.03, 0.04});
  }
  slipped.insert_scan(wall_at(3.64), {0.62, 0.03, 0.04});
  const VoxelMap target = before.finish();
  const VoxelMap source = slipped.finish();
  ASSERT_GT(source.voxels().size(), target.voxels().size() * 3 / 2) << "else nothing is drawn twice";
  const std::size_t cells = common_places(target, target, {}, {}, kPlace_m).size();
  MotionsInTime motions;
  motions.source.back().shift_m.x() = -0.6;
  const std::vector<CommonPlace> places = common_places(source, target, {}, motions, kPlace_m);
  ASSERT_EQ(places.size(), cells);
  double after = 0.0;
  for (const CommonPlace& place : places) after += place.source.back() / static_cast<double>(cells);
  EXPECT_NEAR(after, 0.25, 0.02) << "a quarter of all hits came after";
}

TEST(CommonPlaces, AreFoundWhereTheMotionsPutThemAndStandWhereThePoseDoes) {
  const OccupancyOptions options{.resolution_m = 0.1, .min_range_m = 0.0};
  MapBuilder one(options);
  one.insert_scan(wall_at(3.04), {0.02, 0.03, 0.04});
  MapBuilder other(options);
  other.insert_scan(wall_at(3.04), {0.02, 0.03, 0.04});
  const VoxelMap source = one.finish();
  const VoxelMap target = other.finish();
  const Pose3 off = Pose3::from_translation(0.6, 0.0, 0.0);
  EXPECT_TRUE(common_places(source, target, off, {}, kPlace_m).empty());
  MotionsInTime motions;
  for (SmallMotion& motion : motions.source) motion.shift_m.x() = -0.6;
  const std::vector<CommonPlace> places = common_places(source, target, off, motions, kPlace_m);
  ASSERT_FALSE(places.empty());
  for (const CommonPlace& place : places) EXPECT_NEAR(place.point_m.x(), 3.34, 0.01) << "half way between the two";
}

TEST(MomentsOf, AreThoseOfThePlaces) {
  const std::vector<CommonPlace> places = {{.point_m = {1.0, 0.0, 0.0}}, {.point_m = {3.0, 0.0, 1.0}}};
  const PlaceMoments moments = moments_of(places);
  EXPECT_NEAR((moments.mean_m - Eigen::Vector3d(2.0, 0.0, 0.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(moments.scatter_m2(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(moments.scatter_m2(0, 2), 0.5, 1e-12);
  EXPECT_TRUE(moments_of({}).scatter_m2.isZero(0.0));
  EXPECT_TRUE(moments_of({}).mean_m.allFinite());
}

}  // namespace
}  // namespace kilter
