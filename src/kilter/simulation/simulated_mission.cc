// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/simulated_mission.h"

#include <algorithm>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

constexpr std::uint64_t kScanStream = 1000000;

RobotMotion motion_of(const SimulatedRobot& robot, const Trajectory& trajectory, double start_s) {
  RobotMotion motion{robot.name, robot.T_world_sensor_true, {}};
  for (const double stamp_s : robot.stamp_s) motion.path_m.push_back(trajectory.path_m(stamp_s - start_s));
  return motion;
}

}  // namespace

Expected<SimulatedMission> SimulatedMission::plan(Scene scene, const LidarModel& lidar, std::uint64_t seed) {
  KILTER_EXPECTS(!scene.routes.empty());
  Expected<RayCaster> world = RayCaster::build(scene.world);
  if (!world) return pass_up(world.error());
  SimulatedMission mission(std::move(*world), lidar, seed);
  mission.lidar_.keep_range_m = std::min(lidar.keep_range_m, scene.keep_range_m);
  std::vector<RobotMotion> motions;
  for (std::size_t r = 0; r < scene.routes.size(); ++r) {
    const RobotRoute& route = scene.routes[r];
    const Trajectory trajectory = Trajectory::along(route.corners_m, route.drive);
    SimulatedRobot robot{std::string(1, static_cast<char>('a' + r)), {}, {}, {}};
    for (const double time_s : trajectory.scan_times_s(scene.scan_step_m, scene.scan_step_rad)) {
      robot.stamp_s.push_back(route.start_s + time_s);
      robot.T_world_sensor_true.push_back(trajectory.at(time_s));
    }
    motions.push_back(motion_of(robot, trajectory, route.start_s));
    mission.trajectories_.push_back(trajectory);
    mission.start_s_.push_back(route.start_s);
    mission.robots_.push_back(std::move(robot));
  }
  Expected<SlamResult> slam = run_slam(motions, scene.faults, scene.slam, seed);
  if (!slam) return pass_up(slam.error());
  for (std::size_t r = 0; r < mission.robots_.size(); ++r) {
    mission.robots_[r].T_world_sensor = std::move(slam->T_world_sensor[r]);
  }
  mission.faults_ = std::move(slam->faults);
  return mission;
}

std::size_t SimulatedMission::scan_count() const {
  std::size_t count = 0;
  for (const SimulatedRobot& robot : robots_) count += robot.stamp_s.size();
  return count;
}

SimulatedScan SimulatedMission::scan(std::size_t r, std::size_t i) const {
  const double start_s = start_s_[r];
  const Trajectory& trajectory = trajectories_[r];
  const auto motion = [&](double time_s) { return trajectory.at(time_s - start_s); };
  return simulate_scan(world_, lidar_, motion, robots_[r].stamp_s[i], Rng(seed_, kScanStream * (r + 1) + i));
}

Expected<void> for_each_scan(const SimulatedMission& mission, std::size_t r, const RunContext& run,
                             const std::function<Expected<void>(std::size_t i, const SimulatedScan& scan)>& take) {
  const std::size_t count = mission.robots()[r].stamp_s.size();
  // Enough to keep the threads busy, few enough that memory stays a handful of scans.
  const std::size_t block = 4 * static_cast<std::size_t>(run.threads);
  const RunContext within{.threads = run.threads, .cancelled = run.cancelled};
  std::vector<SimulatedScan> scans(block);
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t size = std::min(block, count - first);
    parallel_for(size, within, [&](std::size_t k) { scans[k] = mission.scan(r, first + k); });
    if (run.stop_requested()) return fail(ErrorCode::kCancelled, "stopped while simulating");
    for (std::size_t k = 0; k < size; ++k) {
      if (Expected<void> taken = take(first + k, scans[k]); !taken) return taken;
    }
    if (run.progress) run.progress(first + size, count);
  }
  return {};
}

}  // namespace kilter
