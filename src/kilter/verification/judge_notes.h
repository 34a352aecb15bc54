// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/verification/judge.h"

// What both judges say of a pair in the same words.
namespace kilter {

/// Theta, or Gamma, this many spreads below the map's own, and at least this many decades, is out of line.
inline constexpr double kThetaSpreads = 3.0;
inline constexpr double kThetaSlack = 0.3;

/// Puts what was measured at both poses among the verdict's evidence, beside what is typical of the map.
void note_measurements(const PairEvidence& pair, const MapNull& null, PairVerdict& verdict);

/// Whether registrations around one that was searched widely ask for another correction. `pair` has a registration.
[[nodiscard]] bool contradicted(const PairEvidence& pair);

/// Why its neighbours, or another pose that fits nearly as well, forbid to believe a registration; empty if they do
/// not. `pair` has one.
[[nodiscard]] std::string doubt_of_rivals(const PairEvidence& pair);

/// What is said of a pair that no registration brought together; empty where one did.
[[nodiscard]] std::string registration_failure(const PairEvidence& pair);

}  // namespace kilter
