// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A building with two loops that share the place where both robots start and end, as in Sec. V-A: robot a goes round
// the eastern loop and closes it, robot b round the western one and does not recognise the hall and the start when it
// comes back. Bends, and doors that close behind the robots, decide which submaps see a common place, so that the
// pairs that the paper discusses overlap much (verified there), a little (rejected there) or not at all.
#include "kilter/simulation/worlds/door.h"
#include "kilter/simulation/worlds/floor_plan.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Way = std::vector<Vector3d>;

constexpr double kHeight_m = 3.4;
constexpr double kWidth_m = 2.2;

// Where the loops turn; all else follows. North is +y. The turns stand where they do so that every submap ends with a
// scan at 9.5 to 9.9 m and none ends by how far its robot turned: the same places in every seed, whatever the odometry
// adds or takes.
struct Plan {
  Vector2d star{0.0, 0.0};  // both start and end here
  Vector2d hook{0.0, 5.2};  // where a's and b's ways home meet
  Vector2d fork{2.0, 6.6};  // a comes down from the north; an opening leads east
  Vector2d knee{4.6, 8.0};
  double east_x = 8.28;
  double a_north_y = 12.13;
  double a_far_x = 20.86;
  double a_top_y = 22.18;
  Vector2d west{-5.66, 0.0};
  Vector2d porch{-11.32, 2.99};  // b goes north from here into the hall
  Vector2d slit{-8.58, 1.54};    // on the way there it can look into the hall
  Vector2d hall_low{-15.0, 6.4};
  Vector2d hall_high{-8.0, 13.0};
  Vector2d lobby{-14.5, 9.3};      // the corner of a room cut out of the hall's south-west
  Vector2d hall_turn{-15.0, 8.0};  // through which b leaves the hall to the west
  double b_far_x = -26.03;
  double b_top_y = 17.47;
  double north_x = -13.7;  // comes back from the north
  double north_turn_y = 9.06;
  double exit_y = 8.96;  // and leaves it to the east
  Vector2d bend{-4.1, 13.85};
};

Way on_floor(const std::vector<Vector2d>& points) {
  Way way;
  for (const Vector2d& point : points) way.emplace_back(point.x(), point.y(), 0.0);
  return way;
}

Way way_of_a(const Plan& p) {
  return on_floor({p.star,
                   {p.east_x, 0.0},
                   {p.east_x, p.a_north_y},
                   {p.a_far_x, p.a_north_y},
                   {p.a_far_x, p.a_top_y},
                   {p.knee.x(), p.a_top_y},
                   p.knee,
                   p.fork,
                   p.hook,
                   p.star});
}

Way way_of_b(const Plan& p) {
  return on_floor({p.star,
                   p.west,
                   p.porch,
                   {p.porch.x(), p.hall_low.y()},
                   p.hall_turn,
                   {p.b_far_x, p.hall_turn.y()},
                   {p.b_far_x, p.b_top_y},
                   {p.north_x, p.b_top_y},
                   {p.north_x, p.north_turn_y},
                   {p.hall_high.x(), p.exit_y},
                   p.bend,
                   p.hook,
                   p.star,
                   p.star - Vector2d(0.9, 0.4)});
}

FloorPlan floor_plan(const Plan& p) {
  FloorPlan plan;
  // Robot a's loop, and two openings: from its last but one leg to the first corridor, and from the fork eastwards.
  plan.add_corridor(p.star, {p.east_x, 0.0}, kWidth_m);
  plan.add_corridor({p.east_x, 0.0}, {p.east_x, p.a_north_y}, kWidth_m);
  plan.add_corridor({p.east_x, p.a_north_y}, {p.a_far_x, p.a_north_y}, kWidth_m);
  plan.add_corridor({p.a_far_x, p.a_north_y}, {p.a_far_x, p.a_top_y}, kWidth_m);
  plan.add_corridor({p.a_far_x, p.a_top_y}, {p.knee.x(), p.a_top_y}, kWidth_m);
  plan.add_corridor({p.knee.x(), p.a_top_y}, p.knee, 2.0);
  plan.add_passage(p.knee, {p.knee.x(), 0.0}, 2.0);
  plan.add_corridor(p.knee, p.fork, 1.6);
  plan.add_passage(p.fork, {p.east_x, p.fork.y() - 0.2}, 0.9);
  plan.add_corridor(p.fork, p.hook, 1.8);
  plan.add_corridor(p.hook, p.star, 2.0);
  // Robot b's loop.
  plan.add_corridor(p.star, p.west, kWidth_m);
  plan.add_corridor(p.west, p.porch, kWidth_m);
  plan.add_passage(p.porch, {p.porch.x(), p.hall_low.y() + 0.2}, 1.8);
  // Of what one submap sees as a strip, another that sees all of it has most voxels within a metre and few in place.
  plan.add_passage(p.slit, {p.slit.x(), p.hall_low.y() + 0.2}, 0.35);
  const double hall_y = 0.5 * (p.hall_low.y() + p.hall_high.y());
  plan.add_passage({p.lobby.x(), hall_y}, {p.hall_high.x(), hall_y}, p.hall_high.y() - p.hall_low.y());
  const double beside_lobby_y = 0.5 * (p.lobby.y() + p.hall_high.y());
  plan.add_passage({p.hall_low.x(), beside_lobby_y}, {p.lobby.x() + 0.2, beside_lobby_y},
                   p.hall_high.y() - p.lobby.y());
  plan.add_passage({p.lobby.x() + 0.2, p.hall_turn.y()}, {p.b_far_x, p.hall_turn.y()}, kWidth_m);
  plan.add_corridor({p.b_far_x, p.hall_turn.y()}, {p.b_far_x, p.b_top_y}, kWidth_m);
  plan.add_corridor({p.b_far_x, p.b_top_y}, {p.north_x, p.b_top_y}, kWidth_m);
  plan.add_passage({p.north_x, p.b_top_y}, {p.north_x, p.hall_high.y() - 0.2}, kWidth_m);
  plan.add_corridor({p.hall_high.x(), p.exit_y}, p.bend, 1.8);
  plan.add_corridor(p.bend, p.hook, 1.8);
  return plan;
}

// Nothing stands on the robots' ways, nor where one looks through: by the walls of the hall's exit, into which b looks
// back from the bend, and before and behind the slit. Nor by the wall that b passes aslant where it enters the hall.
std::vector<Way> kept_free(const Plan& p, std::vector<Way> ways) {
  const Vector2d exit(p.hall_high.x(), p.exit_y);
  const Vector2d along = (p.bend - exit).normalized();
  const Vector2d aside = 0.3 * Vector2d(-along.y(), along.x());
  ways.push_back(on_floor({exit + aside, p.bend + aside}));
  ways.push_back(on_floor({exit - aside, p.bend - aside}));
  ways.push_back(on_floor({p.slit, {p.slit.x(), p.hall_high.y()}}));
  ways.push_back(on_floor({{p.porch.x(), p.hall_low.y()}, {p.lobby.x(), p.hall_low.y()}}));
  return ways;
}

// Columns and tall cabinets stand about in the hall, off the robots' ways.
void furnish_hall(const Plan& p, const std::vector<Way>& ways, TriangleMesh& mesh, Rng& rng) {
  constexpr double kClear_m = 0.9;
  for (double x = p.hall_low.x() + 1.3; x < p.hall_high.x() - 1.0; x += 1.5) {
    for (double y = p.hall_low.y() + 0.9; y < p.hall_high.y() - 0.5; y += 1.9) {
      const Vector2d at_m(x + rng.uniform(-0.4, 0.4), y + rng.uniform(-0.3, 0.3));
      const double yaw_rad = rng.uniform(0.0, 3.0);
      const bool column = rng.uniform() < 0.4;
      if (distance_to_ways_m(ways, at_m) < kClear_m) continue;
      const Eigen::Vector3d size_m = column ? Vector3d(0.4, 0.4, kHeight_m) : Vector3d(0.45, 0.8, 2.0);
      mesh.add_box({.center_m = {at_m.x(), at_m.y(), 0.5 * size_m.z()}, .size_m = size_m, .yaw_rad = yaw_rad},
                   column ? Material::kConcrete : Material::kWood);
    }
  }
}

std::vector<DoorPlace> door_places(const Plan& p) {
  const Vector2d north = Vector2d::UnitY();
  const Vector2d east = Vector2d::UnitX();
  const Vector2d knee_to_fork = p.fork - p.knee;
  const Vector2d west_to_porch = p.porch - p.west;
  const Vector2d bend_to_hook = p.hook - p.bend;
  // Where two doors stand a metre apart, no submap sees the other side of the door that another one sees. Into and out
  // of the hall there are two, so that what 15 sees of it shows 11 nothing, and 9 little.
  return {
      {p.hook - 2.6 * north, north, 2.0, DoorHabit::kAutomatic},
      {p.knee + 0.35 * knee_to_fork, knee_to_fork, 1.6, DoorHabit::kAutomatic},
      {p.knee + 0.75 * knee_to_fork, knee_to_fork, 1.6, DoorHabit::kAutomatic},
      // Where the opening to the east crosses the passage that a looks down from the north, before b comes home.
      {Vector2d(p.knee.x(), p.fork.y() - 0.58), north, 2.0, DoorHabit::kClosesAtLast, 2.6},
      {Vector2d(p.knee.x(), p.fork.y() + 0.38), north, 2.0, DoorHabit::kClosesAtLast, 1.1},
      {Vector2d(p.knee.x() - 1.1, p.fork.y() - 0.08), east, 0.9, DoorHabit::kOpensForGood, 2.2},
      // Hides the far end of that passage from b's return to the start.
      {Vector2d(2.5, 0.0), east, kWidth_m, DoorHabit::kClosesAtLast, 0.8},
      {Vector2d(p.east_x, 1.1), north, kWidth_m, DoorHabit::kAutomatic},
      {Vector2d(p.east_x, 2.15), north, kWidth_m, DoorHabit::kAutomatic, 0.28},
      {p.west + 0.4 * east, east, kWidth_m, DoorHabit::kAutomatic},
      {p.west + 0.3 * west_to_porch, west_to_porch, kWidth_m, DoorHabit::kAutomatic},
      {Vector2d(p.porch.x(), p.hall_low.y()), north, 1.8, DoorHabit::kOpensForGood},
      {Vector2d(p.porch.x(), p.hall_low.y() - 1.1), north, 1.8, DoorHabit::kAutomatic},
      {Vector2d(p.lobby.x() - 0.05, p.hall_turn.y()), east, kWidth_m, DoorHabit::kAutomatic},
      {Vector2d(p.lobby.x() - 1.1, p.hall_turn.y()), east, kWidth_m, DoorHabit::kAutomatic, 0.45},
      {Vector2d(p.b_far_x + 2.0, p.b_top_y), east, kWidth_m, DoorHabit::kAutomatic},
      {Vector2d(p.north_x, p.hall_high.y()), north, kWidth_m, DoorHabit::kClosesAtLast},
      {p.bend + 0.3 * bend_to_hook, bend_to_hook, 1.8, DoorHabit::kAutomatic},
  };
}

}  // namespace

Scene make_paper_indoor(const SceneOptions& options) {
  const Plan plan;
  Scene scene;
  Rng furniture = part_rng(options, WorldPart::kFurniture);
  const std::vector<Way> ways = {way_of_a(plan), way_of_b(plan)};
  floor_plan(plan).build(scene.world.fixed, kHeight_m, kept_free(plan, ways), 0.85, furniture);
  furnish_hall(plan, ways, scene.world.fixed, furniture);
  for (const Way& way : ways) scene.routes.push_back({way, {}, 0.0});
  finish_routes(scene, options, {.speed_mps = 0.7, .sensor_height_m = 1.3});
  scene.routes[1].start_s = 300.0;  // one session after the other
  hang_doors(door_places(plan), kHeight_m, scene);
  scene.scan_step_m = 0.56;
  scene.keep_range_m = 9.0;
  scene.slam.drift.bias_m_per_m = {0.001, 0.001, 0.001};
  scene.slam.drift.bias_rad_per_m = {0.00005, 0.00005, 0.0002};
  scene.slam.drift.yaw_rad_per_rad = 0.001;
  scene.faults = {{.kind = FaultKind::kMissedClosure,
                   .robot = 1,
                   .from = 0.5,
                   .until = 0.68,
                   .at = 0.62,
                   .size_m = 0.63,
                   .size_rad = 0.008,
                   .bearing_rad = 2.6}};
  return scene;
}

}  // namespace kilter
