// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/find_oddities.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kilter/io/pose_reading.h"
#include "kilter/io/stamp_text.h"

namespace kilter {
namespace {

constexpr double kNearlyStill_m = 0.05;
constexpr double kShortPath_m = 5.0;     // too short to tell which way a sensor looks
constexpr double kAlongOwnZ = 0.8;       // share of the path
constexpr double kLidarRange_m = 300.0;  // medians beyond are no lidar's
constexpr double kStep_m = 50.0;         // nor are steps like this a robot's, from scan to scan
constexpr double kJump_m = 5.0;          // at least, and
constexpr double kJumpOfMedian = 20.0;   // this many usual steps
constexpr double kPause_s = 60.0;        // at least, and
constexpr double kPauseOfMedian = 50.0;  // this many usual intervals
constexpr double kFar_m = 200.0;         // no lidar's reach bridges it
constexpr double kBentPath = 0.5;        // cosine between two steps of a path that turns
constexpr double kSameTurn_rad = 1e-6;   // no sensor's attitude is as steady
constexpr double kUpsideDown_rad = 2.0;  // of the sensor's z axis from the world's
constexpr double kTumble_rad = 1.2;      // between the least and the largest of these on the way
constexpr double kIntervalsApart = 0.5;  // that differences between two lists of stamps may spread over
constexpr std::size_t kFewPoints = 1000;
constexpr std::size_t kMostComparisons = 20;  // of whole clouds

template <typename T>
T median_of(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> steps_m(const RobotLog& robot) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < robot.T_world_cloud.size(); ++i) {
    steps.push_back((robot.T_world_cloud[i].translation_m() - robot.T_world_cloud[i - 1].translation_m()).norm());
  }
  return steps;
}

// Share of the path that leads along the sensor's own z axis.
double share_along_own_z(const RobotLog& robot) {
  double along_m = 0.0;
  double path_m = 0.0;
  for (std::size_t i = 1; i < robot.T_world_cloud.size(); ++i) {
    const Pose3& before = robot.T_world_cloud[i - 1];
    const Eigen::Vector3d step_m =
        before.rotation().conjugate() * (robot.T_world_cloud[i].translation_m() - before.translation_m());
    along_m += std::abs(step_m.z());
    path_m += step_m.norm();
  }
  return path_m > 0.0 ? along_m / path_m : 0.0;
}

// Whether a path turns while the sensor never does.
bool turns_without_turning(const RobotLog& robot) {
  const std::vector<Pose3>& poses = robot.T_world_cloud;
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();
  double least_cosine = 1.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if ((poses.front().inverse() * poses[i]).angle_rad() > kSameTurn_rad) return false;
    const Eigen::Vector3d step_m = poses[i].translation_m() - poses[i - 1].translation_m();
    if (step_m.norm() < kNearlyStill_m) continue;
    if (first_m.isZero()) first_m = step_m;
    least_cosine = std::min(least_cosine, first_m.dot(step_m) / (first_m.norm() * step_m.norm()));
  }
  return least_cosine < kBentPath;
}

// How far the sensor's z axis lies from the world's, for each pose. [rad]
std::vector<double> tilts_rad(const RobotLog& robot) {
  std::vector<double> tilts;
  for (const Pose3& T : robot.T_world_cloud) {
    tilts.push_back(std::acos(std::clamp((T.rotation() * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0)));
  }
  return tilts;
}

// How two lists of stamps of the same clouds differ.
struct StampsApart {
  double spread_s = 0.0;  // of the differences: what all of them have in common is another clock
  bool meet = true;       // whether the times from their first to their last overlap
};

StampsApart apart(std::span<const std::int64_t> a_ns, std::span<const std::int64_t> b_ns) {
  std::vector<double> apart_s;
  for (std::size_t i = 0; i < a_ns.size(); ++i) apart_s.push_back(1e-9 * static_cast<double>(a_ns[i] - b_ns[i]));
  const auto [least, most] = std::minmax_element(apart_s.begin(), apart_s.end());
  const auto [first_a, last_a] = std::minmax_element(a_ns.begin(), a_ns.end());
  const auto [first_b, last_b] = std::minmax_element(b_ns.begin(), b_ns.end());
  return {*most - *least, *first_a <= *last_b && *first_b <= *last_a};
}

// Stamps of clouds, as the source or else their names have them, beside those of their poses; absent where only one of
// both is known.
std::optional<StampsApart> stamps_apart(const RobotLog& robot) {
  if (robot.T_world_cloud.empty() || robot.stamps_ns.size() != robot.T_world_cloud.size()) return std::nullopt;
  if (robot.pose_stamps_ns.size() == robot.stamps_ns.size()) return apart(robot.stamps_ns, robot.pose_stamps_ns);
  if (!robot.cloud_name) return std::nullopt;
  std::vector<StampText> named;
  for (std::size_t i = 0; i < robot.stamps_ns.size(); ++i) {
    const std::string name = std::filesystem::path(robot.cloud_name(i)).filename().string();
    const std::optional<StampText> stamp = stamp_of_file(name);
    if (!stamp) return std::nullopt;
    named.push_back(*stamp);
  }
  if (!look_like_stamps(named)) return std::nullopt;
  const auto named_ns = to_nanoseconds(named, guess_unit(named));
  if (!named_ns) return std::nullopt;
  return apart(*named_ns, robot.stamps_ns);
}

std::string_view code_of(PoseReading reading) {
  switch (reading) {
    case PoseReading::kCloudsInWorld:
      return "clouds-in-world";
    case PoseReading::kInverse:
      return "inverse-poses";
    case PoseReading::kTransposed:
      return "transposed-rotations";
    case PoseReading::kScalarFirst:
      return "scalar-first";
    case PoseReading::kOtherRobot:
      return "swapped-poses";
    case PoseReading::kShifted:
      return "shifted-poses";
    case PoseReading::kTurned:
      return "turned-sensor";
    case PoseReading::kMirrored:
      return "mirrored-poses";
    case PoseReading::kOtherAxes:
      return "other-axes";
    case PoseReading::kNeither:
      return "poses-unfit";
  }
  return {};
}

/// Collects what is odd about one robot.
class Finder {
 public:
  Finder(std::span<const RobotLog> robots, std::size_t place, const RobotInspection& seen, std::vector<Oddity>& found)
      : robots_(robots), place_(place), robot_(robots[place]), seen_(seen), found_(found) {}

  void look() {
    const std::size_t before = found_.size();
    look_at_poses();
    look_at_stamps();
    const bool poses_are_odd = found_.size() != before;
    look_at_first_cloud();
    const bool tell_nothing =
        std::any_of(found_.begin() + static_cast<std::ptrdiff_t>(before), found_.end(),
                    [](const Oddity& oddity) { return oddity.code == "millimetres" || oddity.code == "no-motion"; });
    if (!tell_nothing) look_at_reading(poses_are_odd);
    look_at_all_clouds();
    const bool poses_are_left = seen_.poses_found > seen_.clouds && !seen_.poses_are_a_trajectory;
    if (seen_.clouds_found > seen_.clouds || poses_are_left) {
      say("poses-unmatched", fmt::format("{} of {} clouds and {} poses belong together", seen_.clouds,
                                         seen_.clouds_found, seen_.poses_found));
    }
  }

 private:
  void say(std::string_view code, std::string what) { found_.push_back({code, robot_.name, std::move(what)}); }

  void look_at_poses() {
    const std::vector<double> steps = steps_m(robot_);
    if (steps.empty() || robot_.finished_submaps) return;
    if (seen_.path_length_m < kNearlyStill_m) {
      // Most recordings begin before the robot moves.
      if (seen_.clouds_unread > 0) return;
      say("no-motion", fmt::format("{} poses within {:.0f} cm", seen_.clouds, 100.0 * seen_.path_length_m));
      return;
    }
    const double usual_m = median_of(steps);
    if (usual_m > kStep_m) {
      say("millimetres", fmt::format("from cloud to cloud the poses move by {:.0f} m (median)", usual_m));
      return;
    }
    const auto longest = std::max_element(steps.begin(), steps.end());
    if (*longest > std::max(kJump_m, kJumpOfMedian * usual_m)) {
      const auto at = static_cast<std::size_t>(longest - steps.begin());
      say("pose-jump",
          fmt::format("{:.1f} m between clouds {} and {}, usually {:.2f} m", *longest, at, at + 1, usual_m));
    }
    const double along_z = share_along_own_z(robot_);
    if (seen_.path_length_m > kShortPath_m && along_z > kAlongOwnZ) {
      say("camera-frame", fmt::format("{:.0f} % of the path leads along the sensor's own z axis", 100.0 * along_z));
    }
    look_at_attitudes();
  }

  void look_at_attitudes() {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    if (seen_.path_length_m > kShortPath_m && turns_without_turning(robot_)) {
      say("no-turns", "the path turns, and all poses look the same way");
    }
    const std::vector<double> tilts = tilts_rad(robot_);
    const auto [least, most] = std::minmax_element(tilts.begin(), tilts.end());
    if (*most - *least > kTumble_rad) {
      say("tumbles", fmt::format("the sensor's z axis lies {:.0f} to {:.0f} degrees from the world's",
                                 kDegrees * *least, kDegrees * *most));
    } else if (median_of(tilts) > kUpsideDown_rad) {
      say("upside-down", fmt::format("the sensor's z axis lies {:.0f} degrees from the world's (median)",
                                     kDegrees * median_of(tilts)));
    }
  }

  void look_at_stamps() {
    std::vector<double> intervals_s;
    for (std::size_t i = 1; i < robot_.stamps_ns.size(); ++i) {
      intervals_s.push_back(1e-9 * static_cast<double>(robot_.stamps_ns[i] - robot_.stamps_ns[i - 1]));
    }
    if (intervals_s.empty()) return;
    if (seen_.first_ns == seen_.last_ns) {
      say("equal-stamps", fmt::format("all {} are {:.3f} s", robot_.stamps_ns.size(),
                                      1e-9 * static_cast<double>(robot_.stamps_ns.front())));
      return;
    }
    const double usual_s = std::abs(median_of(intervals_s));
    const std::optional<StampsApart> apart = stamps_apart(robot_);
    if (apart && apart->spread_s > kIntervalsApart * usual_s) {
      say("stamps-differ",
          fmt::format("stamps of the clouds and of the poses they go with drift apart by {:.2f} s, where clouds come "
                      "every {:.2f} s",
                      apart->spread_s, usual_s));
    } else if (apart && !apart->meet) {
      say("other-clock", "stamps of the clouds and of the poses they go with have no time in common, but step alike");
    }
    const auto [least, most] = std::minmax_element(intervals_s.begin(), intervals_s.end());
    if (*least < 0.0) {
      const auto at = static_cast<std::size_t>(least - intervals_s.begin());
      const auto others = std::count_if(intervals_s.begin(), intervals_s.end(), [](double s) { return s < 0.0; }) - 1;
      say("time-jump", fmt::format("{:.1f} s back between clouds {} and {}{}", -*least, at, at + 1,
                                   others > 0 ? fmt::format(", and {} times more", others) : ""));
    } else if (*most > std::max(kPause_s, kPauseOfMedian * median_of(intervals_s))) {
      const auto at = static_cast<std::size_t>(most - intervals_s.begin());
      say("time-jump", fmt::format("{:.0f} s between clouds {} and {}, usually {:.2f} s", *most, at, at + 1,
                                   median_of(intervals_s)));
    }
  }

  void look_at_reading(bool poses_are_odd) {
    const std::optional<OtherReading> other = find_other_reading(robots_, place_);
    if (!other) return;
    if (other->reading == PoseReading::kNeither) {
      if (poses_are_odd) return;
      say("poses-unfit",
          fmt::format("{:.0f} % of a cloud's points meet those of the next one, and {:.0f} % those of one "
                      "a few metres away",
                      100.0 * other->otherwise, 100.0 * other->as_given));
      return;
    }
    say(code_of(other->reading), fmt::format("{:.0f} % of a cloud's points meet those of one a few metres away {}, and "
                                             "{:.0f} % with the poses as they are",
                                             100.0 * other->otherwise, other->how, 100.0 * other->as_given));
  }

  void look_at_first_cloud() {
    const std::size_t all = seen_.first_points + seen_.first_dropped;
    if (all == 0) return;
    // Of a cloud in millimetres some points are always near enough to be kept.
    if (seen_.median_range_m.value_or(0.0) > kLidarRange_m) {
      say("millimetres", fmt::format("the first cloud's median range is {:.0f} m, {} of {} points are left out",
                                     *seen_.median_range_m, seen_.first_dropped, all));
    } else if (10 * seen_.first_dropped >= all) {
      say("dropped-points", fmt::format("{} of {} points of the first cloud", seen_.first_dropped, all));
    }
    if (seen_.first_points < kFewPoints) say("few-points", fmt::format("{} in the first cloud", seen_.first_points));
  }

  [[nodiscard]] bool are_identical(std::size_t i, std::size_t k) const {
    const Expected<PointCloud> a = robot_.read_cloud(i);
    const Expected<PointCloud> b = robot_.read_cloud(k);
    return a && b && !a->points_m.empty() && a->points_m == b->points_m;
  }

  // At their first bytes, and at all of those that may be the same as the one before.
  void look_at_all_clouds() {
    if (!robot_.peek_cloud || !robot_.read_cloud) return;
    std::optional<CloudPeek> before;
    std::optional<std::size_t> twice;
    std::size_t compared = 0;
    std::vector<std::size_t> cut_short;
    std::vector<std::size_t> unreadable;
    for (std::size_t i = 0; i < robot_.T_world_cloud.size(); ++i) {
      const std::optional<CloudPeek> here = robot_.peek_cloud(i);
      if (here && here->is_cut_short) cut_short.push_back(i);
      if (!here) unreadable.push_back(i);
      if (!twice && i > 0 && here && before && *here == *before && compared < kMostComparisons) {
        ++compared;
        if (are_identical(i - 1, i)) twice = i;
      }
      before = here;
    }
    if (twice) {
      say("identical-clouds", fmt::format("{} and {}", robot_.cloud_name(*twice - 1), robot_.cloud_name(*twice)));
    }
    say_which("unreadable-clouds", unreadable);
    say_which("damaged-clouds", cut_short);
  }

  void say_which(std::string_view code, std::span<const std::size_t> clouds) {
    if (clouds.empty()) return;
    say(code, fmt::format("{} of {} files, the first is {}", clouds.size(), robot_.T_world_cloud.size(),
                          robot_.cloud_name(clouds.front())));
  }

  std::span<const RobotLog> robots_;
  std::size_t place_;
  const RobotLog& robot_;
  const RobotInspection& seen_;
  std::vector<Oddity>& found_;
};

bool have_the_same_clouds(const RobotLog& a, const RobotLog& b) {
  const std::size_t count = a.T_world_cloud.size();
  if (count == 0 || count != b.T_world_cloud.size() || !a.peek_cloud || !b.peek_cloud) return false;
  const std::array<std::size_t, 3> some = {0, count / 2, count - 1};
  return std::all_of(some.begin(), some.end(), [&](std::size_t i) {
    const std::optional<CloudPeek> peek = a.peek_cloud(i);
    return peek && peek == b.peek_cloud(i);
  });
}

bool have_the_same_places(const RobotLog& a, const RobotLog& b) {
  return std::equal(a.T_world_cloud.begin(), a.T_world_cloud.end(), b.T_world_cloud.begin(), b.T_world_cloud.end(),
                    [](const Pose3& one, const Pose3& other) { return one.translation_m() == other.translation_m(); });
}

void compare_robots(std::span<const RobotLog> robots, std::span<const RobotInspection> seen,
                    std::vector<Oddity>& found) {
  for (const GivenTwice& twice : robots_given_twice(robots)) {
    found.push_back(
        {"identical-robots", robots[twice.later].name,
         fmt::format("its {} are those of {}{}", twice.same_places ? "poses and clouds" : "clouds",
                     printable(robots[twice.earlier].name), twice.same_places ? "" : ", under other poses")});
  }
  for (std::size_t i = 0; i < robots.size(); ++i) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < robots.size(); ++k) {
      if (k == i) continue;
      nearest_m = std::min(nearest_m, seen[i].extent_world_m.exteriorDistance(seen[k].extent_world_m));
    }
    const bool is_whole = std::all_of(seen.begin(), seen.end(), [](const auto& one) { return one.clouds_unread == 0; });
    if (robots.size() > 1 && nearest_m > kFar_m && is_whole) {
      found.push_back({"far-robot", robots[i].name, fmt::format("{:.0f} m from the nearest other", nearest_m)});
    }
  }
}

}  // namespace

std::vector<GivenTwice> robots_given_twice(std::span<const RobotLog> robots) {
  std::vector<GivenTwice> twice;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!have_the_same_clouds(robots[i], robots[k])) continue;
      twice.push_back({i, k, have_the_same_places(robots[i], robots[k])});
      break;
    }
  }
  return twice;
}

std::vector<Oddity> find_oddities(std::span<const RobotLog> robots, std::span<const RobotInspection> seen) {
  std::vector<Oddity> found;
  for (std::size_t i = 0; i < robots.size(); ++i) Finder(robots, i, seen[i], found).look();
  compare_robots(robots, seen, found);
  return found;
}

}  // namespace kilter
