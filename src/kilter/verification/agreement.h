// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/submap/ids.h"

namespace kilter {

/// What one registration asks for: with the target held where the map has it, the source's piece of journey has to
/// move by `T_world_correction` (world frame).
struct Correction {
  PairId id;
  int source_robot = 0;
  int target_robot = 0;
  double source_path_m = 0.0;  ///< where on its robot's journey the source lies
  double target_path_m = 0.0;
  Pose3 T_world_correction;
  Eigen::Vector3d centre_world_m = Eigen::Vector3d::Zero();  ///< the overlap's middle as the source has it in the map
  double sigma_m = 0.0;                                      ///< of the correction's translation at the centre
  double sigma_rad = 0.0;
  double weight = 1.0;  ///< 0..1: how unambiguous the registration is
};

/// How far the registrations around one pair ask for the same as its own.
struct Agreement {
  int agreeing = 0;
  int contradicting = 0;
  double agreeing_weight = 0.0;
  double contradicting_weight = 0.0;
  std::optional<PairId> nearest_agreeing;  ///< the one with the shortest way along both journeys

  /// Next to nothing around asks for the same, and something unambiguous asks for something else. Neighbours beyond a
  /// slip rightly ask for something else, so a few that agree are enough.
  [[nodiscard]] bool contradicted() const {
    return contradicting_weight > kEnoughAgainst && agreeing_weight < kEnoughFor &&
           agreeing_weight < 0.5 * contradicting_weight;
  }
  static constexpr double kEnoughAgainst = 0.5;
  static constexpr double kEnoughFor = 1.2;
};

/// How much odometry may bend between two places that are compared.
struct AgreementOptions {
  double drift_per_metre = 0.01;  ///< as for pairing. [m/m]
  double neighbourhood_m = 40.0;  ///< way along both journeys within which corrections are compared. [m]
};

/// Corrections by where their sources lie on which journey, so that those near one are found without asking all.
class CorrectionIndex {
 public:
  /// They must outlive it. O(n log n).
  CorrectionIndex(std::span<const Correction> corrections, const AgreementOptions& options);

  [[nodiscard]] std::span<const Correction> corrections() const { return corrections_; }
  [[nodiscard]] const AgreementOptions& options() const { return options_; }

  /// Numbers, ascending, of those between the same two robots (or within the same one) as `own`, not farther than the
  /// neighbourhood along both journeys, without itself.
  [[nodiscard]] std::vector<std::size_t> near(const Correction& own) const;

 private:
  std::span<const Correction> corrections_;
  AgreementOptions options_;
  std::vector<std::size_t> order_;  // by robots and the source's path
};

/// Compares each correction with those near it. Two of them close a cycle with the odometry between their ends; they
/// agree if they put the first one's overlap to places nearer than twice their joint standard deviation plus the drift
/// allowed on the way and a decimetre. Where that allowance exceeds half of what they ask for (and half a metre), they
/// say nothing about each other. Within one robot, those that close over none of the same way may agree, but do not
/// contradict: odometry may have slipped under one of them.
/// \return one entry per correction, in order. O(n times the pairs within a neighbourhood).
[[nodiscard]] std::vector<Agreement> compare_corrections(const CorrectionIndex& index);

/// Which correction a pair that is contradicted, or was never registered, should try: that of the best-supported
/// neighbour (most agreeing weight, then the shortest way), as a number of the index; absent if no neighbour has two
/// agreeing ones.
[[nodiscard]] std::optional<std::size_t> suggest_correction(const CorrectionIndex& index,
                                                            std::span<const Agreement> agreements,
                                                            const Correction& pair);

}  // namespace kilter
