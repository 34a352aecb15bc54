// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kilter {
namespace {

using Eigen::Vector3d;

RayCaster caster_of(const TriangleWorld& world) {
  Expected<RayCaster> caster = RayCaster::build(world);
  EXPECT_TRUE(caster.has_value());
  return std::move(*caster);
}

TEST(RayCaster, MeasuresThePlanesDistanceExactly) {
  TriangleWorld world;
  world.fixed.add_floor(-50.0, -50.0, 50.0, 50.0, 0.0, Material::kConcrete);
  const RayCaster caster = caster_of(world);
  Rng rng(1, 0);
  for (int i = 0; i < 200; ++i) {
    const Vector3d origin(rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(0.5, 3.0));
    const Vector3d direction = Vector3d(rng.normal(), rng.normal(), -1.0 - rng.uniform()).normalized();
    const auto hit = caster.at(0.0).first_hit(origin, direction, 100.0);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->range_m, -origin.z() / direction.z(), 1e-12);
    EXPECT_NEAR(hit->normal.z(), 1.0, 1e-12);
    EXPECT_EQ(hit->material, Material::kConcrete);
  }
}

TEST(RayCaster, SeesNothingBeyondItsReach) {
  TriangleWorld world;
  world.fixed.add_box({.center_m = {10.0, 0.0, 0.0}, .size_m = {2.0, 2.0, 2.0}}, Material::kWood);
  const RayCaster caster = caster_of(world);
  EXPECT_FALSE(caster.at(0.0).first_hit(Vector3d::Zero(), Vector3d::UnitX(), 8.9).has_value());
  EXPECT_NEAR(caster.at(0.0).first_hit(Vector3d::Zero(), Vector3d::UnitX(), 9.1)->range_m, 9.0, 1e-12);
  EXPECT_FALSE(caster.at(0.0).first_hit(Vector3d::Zero(), Vector3d::UnitY(), 100.0).has_value());
}

// A block that goes to and fro before a wall.
TriangleWorld world_with_traffic() {
  TriangleWorld world;
  world.fixed.add_box({.center_m = {30.0, 0.0, 0.0}, .size_m = {2.0, 20.0, 4.0}}, Material::kPlaster);
  MovingObject object;
  object.mesh.add_box({.center_m = {0.0, 0.0, 0.5}, .size_m = {2.0, 2.0, 1.0}}, Material::kMetal);
  object.circuit_m = {{10.0, -20.0, 0.0}, {10.0, 20.0, 0.0}};
  object.speed_mps = 2.0;
  world.moving.push_back(object);
  return world;
}

TEST(RayCaster, MovingObjectStandsWhereItsCircuitSays) {
  const RayCaster caster = caster_of(world_with_traffic());
  const Vector3d eye(0.0, 0.0, 0.5);
  EXPECT_NEAR(caster.at(0.0).first_hit(eye, Vector3d::UnitX(), 100.0)->range_m, 29.0, 1e-12);
  const auto hit = caster.at(10.0).first_hit(eye, Vector3d::UnitX(), 100.0);
  EXPECT_NEAR(hit->range_m, 9.0, 1e-6);  // box corners are float
  EXPECT_NEAR(hit->normal.x(), -1.0, 1e-6);
  EXPECT_EQ(hit->material, Material::kMetal);
  EXPECT_NEAR(caster.at(50.0).first_hit(eye, Vector3d::UnitX(), 100.0)->range_m, 9.0, 1e-6) << "one circuit later";
}

TEST(RayCaster, NothingDrivesThroughTheSensor) {
  const RayCaster caster = caster_of(world_with_traffic());
  EXPECT_NEAR(caster.at(10.0).first_hit({10.0, 0.2, 0.5}, Vector3d::UnitX(), 100.0)->range_m, 19.0, 1e-6);
  EXPECT_NEAR(caster.at(10.0).first_hit({8.9, 0.2, 0.5}, Vector3d::UnitX(), 100.0)->range_m, 0.1, 1e-6);
}

TEST(RayCaster, RefusesAnEmptyWorld) {
  const Expected<RayCaster> caster = RayCaster::build(TriangleWorld{});
  ASSERT_FALSE(caster.has_value());
  EXPECT_EQ(caster.error().code, ErrorCode::kInvalidArgument);
}

TEST(TriangleMesh, BoxHasTwelveTrianglesOfTheRightArea) {
  TriangleMesh mesh;
  mesh.add_box({.center_m = {1.0, 2.0, 3.0}, .size_m = {2.0, 3.0, 4.0}, .yaw_rad = 0.7}, Material::kWood);
  ASSERT_EQ(mesh.triangles.size(), 12U);
  double area_m2 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f first = mesh.vertices_m[b] - mesh.vertices_m[a];
    const Eigen::Vector3f second = mesh.vertices_m[c] - mesh.vertices_m[a];
    area_m2 += 0.5 * static_cast<double>(first.cross(second).norm());
  }
  EXPECT_NEAR(area_m2, 2.0 * (2.0 * 3.0 + 3.0 * 4.0 + 2.0 * 4.0), 1e-4);
}

TEST(TriangleMesh, PrismApproachesTheCylinder) {
  TriangleWorld world;
  world.fixed.add_prism({0.0, 0.0, 0.0}, 1.0, 1.0, 2.0, 64, Material::kConcrete);
  const RayCaster caster = caster_of(world);
  for (const double angle : {0.1, 1.7, 3.9, 5.5}) {
    const Vector3d outwards(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d eye = 5.0 * outwards + Vector3d(0.0, 0.0, 1.0);
    const double range_m = caster.at(0.0).first_hit(eye, -outwards, 100.0)->range_m;
    EXPECT_GE(range_m, 4.0 - 1e-6);
    EXPECT_LE(range_m, 5.0 - std::cos(std::numbers::pi / 64.0) + 1e-6);
  }
}

}  // namespace
}  // namespace kilter
