// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "kilter/geometry/pose3.h"
#include "kilter/registration/registration.h"

namespace kilter {

/// How far registration moves the places that both submaps saw, and how sure that is.
///
/// A motion (v, w) about the overlap's centre displaces a place at arm a by v + w x a; over all places the mean square
/// is x^T M x with x = (v, w), M = diag(I, tr(S) I - S) and S the scatter of the places. `offset_m` is its root.
struct OffsetEstimate {
  double offset_m = 0.0;
  double offset_rad = 0.0;
  Eigen::Vector3d vector_m = Eigen::Vector3d::Zero();  ///< displacement at the middle of the places, target axes
  /// Mean and variance of x^T M x for x around the estimate: with what was measured, and with the prior's uncertainty
  /// along unobservable directions on top. [m^2], [m^4]
  struct SquareLaw {
    double mean_m2 = 0.0;
    double variance_m4 = 0.0;
  };
  SquareLaw measured;
  SquareLaw with_prior;
  /// By so much uncertainty alone makes offset_m^2 larger than the true one, on average. [m^2]
  [[nodiscard]] double bias_m2() const { return measured.mean_m2 - offset_m * offset_m; }
  double sigma_m = 0.0;  ///< standard deviation of the offset along the estimate (largest one at zero). [m]
  double minimum_detectable_m = 0.0;  ///< 95 % sure to be told from zero at 5 %, in the worst observable direction
  double cells_sigma_m = 0.0;         ///< the part of its uncertainty that comes from cells, RMS. [m]
  double hidden_sigma_m = 0.0;        ///< RMS displacement that unobservable directions could hide, one sigma. [m]
};

/// Precondition: the registration converged.
[[nodiscard]] OffsetEstimate estimate_offset(const RegistrationResult& registration, const Pose3& T_target_source_map);

/// Relative standard deviation between an RMS over the places that two maps show and that over all that beams of both
/// hit, which is what a disagreement is: 1 to 2 % in the middle, with longer tails, seen where the truth is known
/// (`benchmarks/accuracy/run`).
inline constexpr double kPlacesScatter = 0.03;
/// The same where parts of a bend are told by place: places are then where the planes lie that were matched.
inline constexpr double kMatchedPlacesScatter = 0.05;
[[nodiscard]] double places_scatter(const Bend& bend);

/// The law of the squared disagreement: what a rigid motion moves, what none mends, and places_scatter().
[[nodiscard]] OffsetEstimate::SquareLaw disagreement_law(const OffsetEstimate::SquareLaw& offset, const Bend& bend);

/// ln P(offset > limit) and ln P(offset <= limit) under a law of the squared offset, by the Wilson-Hilferty
/// cube-root form of a scaled chi-square with the same two moments.
struct LogTails {
  double above = 0.0;
  double below = 0.0;
};
[[nodiscard]] LogTails log_tails(const OffsetEstimate::SquareLaw& law, double limit_m);

/// The same where unfixed directions hide something on top of what was measured, which can only add to it: two moments
/// do not tell that, and would put some of a wide law below what is known to be there.
[[nodiscard]] LogTails log_tails_with_hidden(const OffsetEstimate::SquareLaw& measured,
                                             const OffsetEstimate::SquareLaw& with_prior, double limit_m);

/// Offset that is exceeded with probability `tail`, in (0, 1). [m]
[[nodiscard]] double offset_quantile_m(const OffsetEstimate::SquareLaw& law, double tail);

}  // namespace kilter
