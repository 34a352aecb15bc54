// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "kilter/verification/verdict.h"

namespace kilter {

/// Red, green, blue.
using Rgb = std::array<std::uint8_t, 3>;

/// Red, green, blue of a robot; eight colours that people who see few of them can still tell apart, then again.
[[nodiscard]] Rgb robot_colour(int robot);

/// Told apart by brightness too; pictures draw inconsistent pairs thicker besides.
[[nodiscard]] Rgb verdict_colour(Verdict verdict);

/// Perceptually even and safe for colour-blind eyes (viridis): 0 dark, 1 bright.
[[nodiscard]] Rgb scale_colour(double share);

/// For values that have no place on a logarithmic scale.
[[nodiscard]] Rgb below_scale_colour();

/// Of a byte of CloudPicture::misalignment: grey where no believed registration tells, then from calm to alarming
/// between a tenth of the tolerance and ten times it, logarithmically.
[[nodiscard]] Rgb misalignment_colour(std::uint8_t byte, double tolerance_m);

/// All of these as JSON, for the page.
[[nodiscard]] std::string palette_json();

}  // namespace kilter
