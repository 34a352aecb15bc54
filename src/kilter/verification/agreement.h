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

/// A registration that so many around it agree with is supported.
inline constexpr int kSupported = 2;

/// How far the registrations around one pair ask for the same as its own.
struct Agreement {
  int agreeing = 0;
  int contradicting = 0;
  double agreeing_weight = 0.0;
  double contradicting_weight = 0.0;
  /// How many of those that are believed on their own ask for the same (count_vouching); of a pair that was not
  /// registered, how many would move it (count_movers).
  int vouching = 0;
  int movers = 0;

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

/// What a pair's verdict, before its neighbours were heard, says of the correction that it asks for.
enum class Standing {
  kDoubted,  ///< nothing: its registration is not believed
  kMoves,    ///< believed: the map's pose is wrong
  kStays,    ///< believed: the map's pose is right
};

/// How many of the pairs around each vouch for the move that it asks for: believed ones that move, and ask for the same
/// as compare_corrections has it, and differ from it by half of the move at most, so that what odometry may have bent
/// is not taken for a move. 0 unless one of them shares its source and one its target (or a slip beside one of the two
/// would explain it), or if a believed one that stays and could tell does not ask for the same. Moves below
/// `tolerance_m` at the overlap's middle, pure turns about it among them, are not vouched for. Within one robot only
/// pairs that close over some of the same way count. \param standings  of each, in order
/// \return a number each, in order. O(n times the pairs within a neighbourhood).
[[nodiscard]] std::vector<int> count_vouching(const CorrectionIndex& index, std::span<const Standing> standings,
                                              double tolerance_m);

/// The same for a pair that was not registered and asks for nothing: how many of those around it would move the place
/// at `pair.centre_world_m` by more than `tolerance_m` and what odometry may have bent on the way. 0 unless they put it
/// to the same place, one of them shares its source, one its target and one neither (slips beside both that undo each
/// other would move that one twice as far), and no believed one that could tell leaves it where it is. O(pairs within a
/// neighbourhood, squared).
[[nodiscard]] int count_movers(const CorrectionIndex& index, std::span<const Standing> standings,
                               const Correction& pair, double tolerance_m);

/// Which correction a pair that is contradicted, or was never registered, should try: that of the best-supported
/// neighbour (most agreeing weight, then the shortest way), as a number of the index; absent if no neighbour is
/// supported.
[[nodiscard]] std::optional<std::size_t> suggest_correction(const CorrectionIndex& index,
                                                            std::span<const Agreement> agreements,
                                                            const Correction& pair);

}  // namespace kilter
