// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace kilter {

/// Which vector instructions a kernel uses. Kernels that offer several do the same operations in the same precision on
/// each element, so that the answer is the same to the bit.
enum class VectorPath {
  kBaseline,  ///< registers of 16 bytes, what every 64-bit processor has
  kAvx2,      ///< of 32, and the instructions of its day that count and pick bits: POPCNT, LZCNT, BMI, BMI2
  kAvx512,    ///< of 64, and these
  kNeon,      ///< of 16 too, where a kernel uses more of 64-bit ARM than the baseline does
};

/// The paths that this processor has, the widest last.
[[nodiscard]] std::span<const VectorPath> vector_paths();

}  // namespace kilter
