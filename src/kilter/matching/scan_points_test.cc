// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_points.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

// Points on a coarse lattice, so that many are equally near.
PackedPoints lattice_points(std::size_t count, std::uint64_t seed) {
  PackedPoints points(count);
  Rng rng(seed, 0);
  for (std::size_t i = 0; i < count; ++i) {
    points.x[i] = static_cast<float>(rng.bits() % 5);
    points.y[i] = static_cast<float>(rng.bits() % 5);
    points.z[i] = static_cast<float>(rng.bits() % 3);
  }
  return points;
}

// The definition, one point at a time.
NearestPoint first_nearest(const PackedPoints& points, std::uint32_t first, std::uint32_t end,
                           const std::array<float, 3>& at, NearestPoint best) {
  for (std::uint32_t i = first; i < end; ++i) {
    const float dx = points.x[i] - at[0];
    const float dy = points.y[i] - at[1];
    const float dz = points.z[i] - at[2];
    const float square_m2 = dx * dx + dy * dy + dz * dz;
    if (square_m2 < best.square_m2 || (square_m2 == best.square_m2 && i < best.index)) best = {square_m2, i};
  }
  return best;
}

TEST(ScanPoints, EveryPathFindsTheFirstOfTheNearest) {
  for (const VectorPath path : vector_paths()) {
    const ScanPoints scan = scan_points_with(path);
    for (const std::size_t count : {1U, 3U, 4U, 7U, 16U, 17U, 64U, 131U}) {
      const PackedPoints points = lattice_points(count, count);
      Rng rng(9, count);
      for (int k = 0; k < 300; ++k) {
        const std::array<float, 3> at = {static_cast<float>(rng.bits() % 10) / 2,
                                         static_cast<float>(rng.bits() % 10) / 2,
                                         static_cast<float>(rng.bits() % 6) / 2};
        const auto first = static_cast<std::uint32_t>(rng.bits() % count);
        // The whole rest, since it may look behind an earlier end.
        const auto end = static_cast<std::uint32_t>(count);
        NearestPoint best{static_cast<float>(rng.uniform(0.0, 6.0)), kNoPoint};
        const NearestPoint expected = first_nearest(points, first, end, at, best);
        scan(points, first, end, at.data(), best);
        ASSERT_EQ(best.index, expected.index) << "path " << static_cast<int>(path) << ", " << count << " points";
        ASSERT_EQ(best.square_m2, expected.square_m2);
      }
    }
  }
}

TEST(ScanPoints, KeepsWhatIsNearerOrAsNearAndEarlier) {
  const PackedPoints points = lattice_points(40, 1);
  const std::array<float, 3> at = {points.x[30], points.y[30], points.z[30]};
  for (const VectorPath path : vector_paths()) {
    NearestPoint best{0.0F, 0};
    scan_points_with(path)(points, 20, 40, at.data(), best);
    EXPECT_EQ(best.index, 0U);
    best = {0.0F, 39};
    scan_points_with(path)(points, 20, 40, at.data(), best);
    EXPECT_LE(best.index, 30U);
  }
}

TEST(ScanPoints, RoomBehindTheLastPointIsNeverNear) {
  PackedPoints points(1);
  points.x[0] = points.y[0] = points.z[0] = 100.0F;
  const std::array<float, 3> at = {0.0F, 0.0F, 0.0F};
  for (const VectorPath path : vector_paths()) {
    NearestPoint best{std::numeric_limits<float>::max(), kNoPoint};
    scan_points_with(path)(points, 0, 1, at.data(), best);
    EXPECT_EQ(best.index, 0U);
  }
}

}  // namespace
}  // namespace kilter
