// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace kilter {

/// Scaled complementary error function, exp(x^2) erfc(x): finite and accurate where erfc underflows. +infinity for
/// x < -26.6, where it exceeds the range of double. NaN for NaN. Relative error below 4e-15.
[[nodiscard]] double erfcx(double x);

/// log of the standard normal's upper tail, log P(Z > z), for every z: what a p-value becomes once it underflows.
/// 0 at -infinity, -infinity at +infinity. Relative error below 4e-15.
[[nodiscard]] double log_normal_tail(double z);

}  // namespace kilter
