// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kilter {

/// Points as three columns, with room behind the last one so that whole registers can be read from any of them.
class PackedPoints {
 public:
  static constexpr std::size_t kRoom = 16;  // lanes of the widest register
  static constexpr float kNowhere = 1e18F;  // what stands there: its square is finite and beyond any limit

  PackedPoints() = default;
  explicit PackedPoints(std::size_t count)
      : x(count + kRoom, kNowhere), y(count + kRoom, kNowhere), z(count + kRoom, kNowhere) {}

  std::vector<float> x, y, z;
};

/// The nearest point found so far.
struct NearestPoint {
  float square_m2 = 0.0F;
  std::uint32_t index = 0;
};

/// Which instructions look through points.
enum class VectorPath {
  kBaseline,  ///< four floats at once, what every 64-bit processor can
  kAvx2,      ///< eight
  kAvx512,    ///< sixteen
};

/// Looks through points [first, end) for one nearer to `point` than `best`, or as near with a lower number. Points
/// up to kRoom - 1 places behind `end` may be found too: whole registers are read.
using ScanPoints = void (*)(const PackedPoints& points, std::uint32_t first, std::uint32_t end, const float* point,
                            NearestPoint& best);

/// The paths that this processor has, the widest last.
[[nodiscard]] std::span<const VectorPath> vector_paths();

/// All of them do the same operations on each point in the same precision, so that the answer is the same to the bit.
[[nodiscard]] ScanPoints scan_points_with(VectorPath path);

}  // namespace kilter
