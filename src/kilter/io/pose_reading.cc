// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reading.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "kilter/io/cloud_looks.h"
#include "kilter/io/other_readings.h"

namespace kilter {
namespace {

// Before cells had a border (CloudLooks), the best of the other readings met 1.02 times as many points at most where
// nothing was wrong, and where something was, the right one 1.27 times at least.
constexpr double kMoreMeet = 1.2;        // times as many points, or, in
constexpr double kMoreMeetAtSome = 1.4;  // some pairs
// Under the right reading as many points meet as of the next cloud, whose place hardly matters: then 0.86 of them or
// more, and up to 0.83 under the best of readings where none was right.
constexpr double kLikeNext = 0.85;
// Where a mounting was left out and is none that is tried, inverted poses fit better too, and reach 0.39 to 0.64, and
// 0.03 to 0.16 meet as given.
constexpr double kUnlikeNext = 0.25;
constexpr std::size_t kScreenEvery = 4;  // each fourth tells which readings are worth all of them,
constexpr double kLikely = 0.95;         // this near to the best
constexpr double kLeastGain = 1.05;      // less is never clear
constexpr double kFitsWell = 0.9;        // of the next cloud: needs no finer search
constexpr double kFewMeet = 0.1;         // of the next cloud
constexpr double kSameShare = 0.98;      // of the best: as good
constexpr std::size_t kFewestTurns = 3;
constexpr double kSmallTurn_rad = 0.2;  // that a map which is bent may fit better with
constexpr double kNearlyAsGood = 0.9;
constexpr double kFirstTurn_rad = 0.08;
constexpr double kFinestTurn_rad = 0.02;
constexpr double kLeastMounting_rad = 0.05;

// How much better a reading is than poses as given, over all looks: as given where it has no poses. 1 where it has too
// little to show, or makes other looks worse.
double gain_of(const Shares& shares, const CloudLooks& looks) {
  if (3 * shares.looks < 2 * looks.size() || shares.looks < kFewestLooks || 6 * shares.worse > shares.looks) return 1.0;
  const double part = static_cast<double>(shares.looks) / static_cast<double>(looks.size());
  return 1.0 + part * (shares.meets - shares.as_given) / std::max(looks.as_given(), kShareMore);
}

// A mounting between those that are tried: by turns of a few degrees about each axis, for as long as more points meet.
Eigen::Matrix3d refined(const RobotLog& robot, const CloudLooks& looks, Eigen::Matrix3d R_body_sensor) {
  double most = looks.of(turned_reading(robot, R_body_sensor), kScreenEvery).meets;
  for (double step_rad = kFirstTurn_rad; step_rad >= kFinestTurn_rad; step_rad /= 2.0) {
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (int turn = 0; turn < 6; ++turn) {
        const Eigen::AngleAxisd by(turn < 3 ? step_rad : -step_rad, Eigen::Vector3d::Unit(turn % 3));
        const Eigen::Matrix3d tried = R_body_sensor * by.toRotationMatrix();
        const double meets = looks.of(turned_reading(robot, tried), kScreenEvery).meets;
        if (meets <= most) continue;
        most = meets;
        R_body_sensor = tried;
        is_better = true;
      }
    }
  }
  return R_body_sensor;
}

struct Tried {
  Reading reading;
  Shares shares;
  double gain = 1.0;
};

std::vector<Tried> try_all(std::span<const RobotLog> robots, std::size_t place, const CloudLooks& looks) {
  std::vector<Tried> all;
  double likely = 0.0;
  for (Reading& reading : other_readings(robots, place)) {
    const Shares shares = looks.of(reading, kScreenEvery);
    all.push_back({std::move(reading), shares, gain_of(shares, looks)});
    likely = std::max(likely, all.back().gain);
  }
  for (Tried& tried : all) {
    if (tried.gain < std::max(kLeastGain, kLikely * likely)) continue;
    tried.shares = looks.of(tried.reading);
    tried.gain = gain_of(tried.shares, looks);
  }
  const auto better = [](const Tried& a, const Tried& b) { return a.gain < b.gain; };
  const auto best = std::max_element(all.begin(), all.end(), better);
  const bool may_be_turned =
      best->reading.kind == PoseReading::kTurned || best->shares.meets < kFitsWell * looks.next_meets();
  if (!may_be_turned || robots[place].finished_submaps) return all;
  const RobotLog& robot = robots[place];
  Eigen::Matrix3d from = Eigen::Matrix3d::Identity();
  double most = 1.0;
  for (const Tried& tried : all) {
    if (tried.reading.kind != PoseReading::kTurned || tried.gain <= most) continue;
    most = tried.gain;
    from = tried.reading.R_body_sensor;
  }
  Tried mounting{turned_reading(robot, refined(robot, looks, from)), {}, 1.0};
  if (Eigen::AngleAxisd(mounting.reading.R_body_sensor).angle() < kLeastMounting_rad) return all;
  mounting.shares = looks.of(mounting.reading);
  mounting.gain = gain_of(mounting.shares, looks);
  // By itself a turn that ends near a plain one is that one.
  if (mounting.gain * kSameShare > best->gain) all.insert(all.begin(), std::move(mounting));
  return all;
}

bool is_clear(const Shares& shares) {
  const bool is_on_average = shares.meets > kMoreMeet * shares.as_given;
  // Along straight ways most readings are the same.
  const bool is_at_some = shares.better >= kFewestLooks && shares.gain_there > kMoreMeetAtSome;
  return (is_on_average || is_at_some) && shares.meets > shares.as_given + kShareMore;
}

OtherReading to_reading(const Reading& reading, const Shares& shares) {
  return {reading.kind, shares.as_given, shares.meets, reading.how};
}

// The plainest of those as good as the best, if it is clear and meets as it should; with what looks alike: a level
// robot's y axis turned over is a sensor on its head, and may be another robot's way.
std::optional<OtherReading> plainest(const std::vector<Tried>& all, double next_meets) {
  double most = 0.0;
  for (const Tried& tried : all) most = std::max(most, tried.gain);
  const auto is_as_good = [&](const Tried& tried) { return tried.gain >= kSameShare * most; };
  const auto first = std::find_if(all.begin(), all.end(), is_as_good);
  const double meets = first->shares.meets;
  if (!is_clear(first->shares) || meets < std::max(kFewMeet, kLikeNext * next_meets)) return std::nullopt;
  const bool is_shift = first->reading.kind == PoseReading::kShifted;
  const auto is_no_shift = [&](const Tried& tried) {
    return is_as_good(tried) && tried.reading.kind != PoseReading::kShifted;
  };
  if (is_shift && std::any_of(all.begin(), all.end(), is_no_shift)) return std::nullopt;
  OtherReading found = to_reading(first->reading, first->shares);
  const auto looks_alike = [](PoseReading kind) {
    return kind == PoseReading::kMirrored || kind == PoseReading::kTurned || kind == PoseReading::kOtherRobot;
  };
  std::vector<PoseReading> told = {found.reading};
  for (auto tried = first; tried != all.end() && looks_alike(found.reading); ++tried) {
    const PoseReading kind = tried->reading.kind;
    if (!looks_alike(kind) || !is_as_good(*tried) || std::find(told.begin(), told.end(), kind) != told.end()) continue;
    if (found.reading == PoseReading::kTurned && kind == PoseReading::kMirrored) continue;
    told.push_back(kind);
    found.how += ", or " + tried->reading.how;
  }
  return found;
}

// Walls leave their cells where a map is bent by some centimetres a metre, and any reading that keeps them parallel
// fits better. So it has to fit better in turns, and than a turn of a few degrees would.
bool is_more_than_a_bend(const RobotLog& robot, const CloudLooks& looks, const OtherReading& found) {
  if (found.reading == PoseReading::kInverse) return true;
  if (looks.turns() < kFewestTurns) return false;
  if (robot.finished_submaps || found.reading == PoseReading::kTurned) return true;
  const Eigen::Matrix3d turn = refined(robot, looks, Eigen::Matrix3d::Identity());
  if (Eigen::AngleAxisd(turn).angle() > kSmallTurn_rad) return true;
  return looks.of(turned_reading(robot, turn)).meets < kNearlyAsGood * found.otherwise;
}

std::optional<OtherReading> likelier_reading(std::span<const RobotLog> robots, std::size_t place,
                                             const CloudLooks& looks) {
  if (looks.poor() == 0 && looks.as_given() > kLikeNext * looks.next_meets()) return std::nullopt;
  std::optional<OtherReading> found = plainest(try_all(robots, place, looks), looks.next_meets());
  if (found && !is_more_than_a_bend(robots[place], looks, *found)) found.reset();
  return found;
}

}  // namespace

std::optional<OtherReading> find_other_reading(std::span<const RobotLog> robots, std::size_t place) {
  const RobotLog& robot = robots[place];
  if (!robot.read_cloud) return std::nullopt;
  const CloudLooks looks(robot);
  if (looks.empty()) return std::nullopt;
  std::optional<OtherReading> other = likelier_reading(robots, place, looks);
  if (looks.go_along()) {
    const Reading in_world{
        PoseReading::kCloudsInWorld, "without their poses", [](std::size_t) { return std::optional(Pose3()); }, {}};
    const Shares shares = looks.of(in_world);
    if (is_clear(shares) && (!other || shares.meets >= kSameShare * other->otherwise)) {
      return to_reading(in_world, shares);
    }
  }
  if (other) return other;
  // Finished submaps lie too far apart for what else they show to mean much.
  const double next_near = looks.next_meets_near();
  const bool is_neither =
      !robot.finished_submaps && next_near > kFewMeet && looks.as_given_near() < kUnlikeNext * next_near;
  if (!is_neither) return std::nullopt;
  return OtherReading{PoseReading::kNeither, looks.as_given_near(), next_near, {}};
}

}  // namespace kilter
