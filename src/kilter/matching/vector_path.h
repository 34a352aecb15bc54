// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace kilter {

/// Which instructions look through points.
enum class VectorPath {
  kBaseline,  ///< four floats at once, what every 64-bit processor can
  kAvx2,      ///< eight
  kAvx512,    ///< sixteen
};

/// The paths that this processor has, the widest last.
[[nodiscard]] std::span<const VectorPath> vector_paths();

}  // namespace kilter
