// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "kilter/io/other_readings.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Fewer pairs of clouds tell nothing.
inline constexpr std::size_t kFewestLooks = 3;
/// A smaller difference between shares of points is none.
inline constexpr double kShareMore = 0.03;

/// How much of clouds meets under one reading of their poses.
struct Shares {
  double meets = 0.0;       ///< share of points in cells that the other cloud of the pair occupies: mean over pairs
  double as_given = 0.0;    ///< the same of the same pairs under the poses as they are
  std::size_t looks = 0;    ///< pairs that the reading has poses for; none if it keeps the robot where it is
  std::size_t worse = 0;    ///< of these, those at which far fewer points meet than as given,
  std::size_t better = 0;   ///< and those with far more,
  double gain_there = 1.0;  ///< this many times as many
};

/// Some pairs of a robot's clouds that show about the same place: one to three metres of way or half a radian apart;
/// neighbours where clouds lie farther apart, and of finished submaps.
class CloudLooks {
 public:
  /// Reads up to three clouds for each of a dozen pairs. Empty where there are too few. The robot must outlive it.
  explicit CloudLooks(const RobotLog& robot);

  [[nodiscard]] bool empty() const { return looks_.empty(); }
  [[nodiscard]] std::size_t size() const { return looks_.size(); }

  /// \param every  takes each n-th point alone: shares to a few thousandths for 4.
  /// Cost: a look-up for each of 6,000 points of each pair.
  [[nodiscard]] Shares of(const Reading& reading, std::size_t every = 1) const;

  /// Share of points that meets under the poses as they are. Mean over pairs.
  [[nodiscard]] double as_given() const { return mean(as_given_); }
  /// Of the points of the cloud after a pair's first, wherever it may be, the share that meets: what a right reading
  /// comes near. Mean over pairs.
  [[nodiscard]] double next_meets() const { return mean(next_meets_); }
  /// The same, and the share as given, where clouds are near each other on the way: medians; 0 where none are.
  [[nodiscard]] double next_meets_near() const { return median_near(next_meets_); }
  [[nodiscard]] double as_given_near() const { return median_near(as_given_); }

  /// How many pairs show a turn of half a radian or more. Along a straight way many readings are the same.
  [[nodiscard]] std::size_t turns() const;
  /// How many pairs meet far worse as given than the next cloud does.
  [[nodiscard]] std::size_t poor() const;

  /// Whether clouds go along with the poses, as they do in the world's frame. The robot's own body and the rings on the
  /// floor around it meet wherever it goes, in the sensor's frame.
  [[nodiscard]] bool go_along() const;

 private:
  struct Pair {
    std::size_t first = 0;
    std::size_t second = 0;
  };
  // Which cells around a cloud's middle hold points of it: a bit for each.
  class NearCells {
   public:
    NearCells() = default;
    NearCells(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& middle_m);
    // Share of each n-th point that falls into them.
    [[nodiscard]] double share_of(const std::vector<Eigen::Vector3d>& points_m, const Pose3& T_cells_points,
                                  std::size_t every) const;

   private:
    Eigen::Vector3d low_ = Eigen::Vector3d::Zero();  // [cells]
    std::vector<bool> holds_;                        // x fastest
  };
  struct Look {
    Pair pair;
    bool is_near = false;  // the two lie near each other on the way
    NearCells first;
    std::vector<Eigen::Vector3d> second_m;
    Eigen::Vector3d off_sensor_m = Eigen::Vector3d::Zero();  // the first cloud's middle from where its pose is
  };

  static std::vector<Pair> evenly(std::vector<Pair> pairs);
  [[nodiscard]] std::vector<Pair> pairs_on_the_way() const;
  [[nodiscard]] std::vector<Pair> pairs_of_neighbours() const;
  [[nodiscard]] std::vector<Pair> pairs_in_turns() const;
  void look_at(const Pair& pair, bool is_near);
  [[nodiscard]] const Pose3& first_pose(const Look& look) const { return robot_.T_world_cloud[look.pair.first]; }
  [[nodiscard]] const Pose3& second_pose(const Look& look) const { return robot_.T_world_cloud[look.pair.second]; }
  [[nodiscard]] static double mean(const std::vector<double>& shares);
  [[nodiscard]] double median_near(const std::vector<double>& shares) const;

  const RobotLog& robot_;
  std::vector<Look> looks_;
  std::vector<double> as_given_;    // of each look
  std::vector<double> next_meets_;  // of each look
};

}  // namespace kilter
