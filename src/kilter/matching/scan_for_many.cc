// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_for_many.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kilter/matching/cluster_gaps.h"

namespace kilter {
namespace {

// Groups whose gaps are remembered; more are looked through in parts.
constexpr std::size_t kMostGroups = 64;

// The gaps between a box and those of kMostLanes clusters. [m^2]
template <std::uint32_t kLanes, typename Columns>
[[gnu::always_inline]] inline void gaps_to(const Columns& boxes, std::uint32_t first, const FloatBox& box,
                                           AskingPoints::Floats& gaps_m2) {
  for (std::uint32_t from = 0; from < kMostLanes; from += kLanes) {
    typename Register<kLanes>::Floats gaps;
    square_gaps<kLanes>(boxes, first + from, box.low_m.data(), box.high_m.data(), gaps);
    std::memcpy(gaps_m2.data() + from, &gaps, sizeof(gaps));
  }
}

// A bit for each gap that is at most so much.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline std::uint32_t gaps_within(const AskingPoints::Floats& gaps_m2, float at_most) {
  using Floats = typename Register<kLanes>::Floats;
  using Ints = typename Register<kLanes>::Ints;
  Ints chosen{};
  for (std::uint32_t from = 0; from < kMostLanes; from += kLanes) {
    Floats gaps;
    Ints bits;
    std::memcpy(&gaps, gaps_m2.data() + from, sizeof(gaps));
    std::memcpy(&bits, kLaneBits.data() + from, sizeof(bits));
    chosen |= gaps <= Floats{} + at_most ? bits : Ints{};
  }
  return any_of<kLanes>(chosen);
}

template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void pick(const ClusterBoxes& boxes, std::uint32_t first, std::uint32_t end,
                                        const FloatBox& box, float above_m2, float at_most_m2,
                                        std::vector<ClusterGroup>& groups) {
  for (; first < end; first += kMostLanes) {
    AskingPoints::Floats gaps_m2;
    gaps_to<kLanes>(boxes, first, box, gaps_m2);
    std::uint32_t lanes = gaps_within<kLanes>(gaps_m2, at_most_m2) & ~gaps_within<kLanes>(gaps_m2, above_m2);
    if (end - first < kMostLanes) lanes &= (1U << (end - first)) - 1;
    for (; lanes != 0; lanes &= lanes - 1) {
      if (groups.empty() || groups.back().full()) groups.emplace_back(0.0F);
      groups.back().add(boxes, first + static_cast<std::uint32_t>(std::countr_zero(lanes)));
    }
  }
}

// In Eigen's order of operations.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void move(const Eigen::Isometry3d& T, AskingPoints& asking) {
  using Doubles = typename Register<kLanes>::Doubles;
  using Floats = typename Register<kLanes>::Floats;
  for (std::uint32_t from = 0; from < kMostLanes; from += kLanes / 2) {
    Doubles x_m;
    Doubles y_m;
    Doubles z_m;
    std::memcpy(&x_m, asking.at_m[0].data() + from, sizeof(x_m));
    std::memcpy(&y_m, asking.at_m[1].data() + from, sizeof(y_m));
    std::memcpy(&z_m, asking.at_m[2].data() + from, sizeof(z_m));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      const Doubles at_m = T(row, 0) * x_m + T(row, 1) * y_m + T(row, 2) * z_m + T(row, 3);
      const auto rounded_m = __builtin_convertvector(at_m, typename Register<kLanes>::HalfFloats);
      std::memcpy(asking.at_m[axis].data() + from, &at_m, sizeof(at_m));
      std::memcpy(asking.rounded_m[axis].data() + from, &rounded_m, sizeof(rounded_m));
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Floats low;
    std::memcpy(&low, asking.rounded_m[axis].data(), sizeof(low));
    Floats high = low;
    for (std::uint32_t from = kLanes; from < kMostLanes; from += kLanes) {
      Floats lanes;
      std::memcpy(&lanes, asking.rounded_m[axis].data() + from, sizeof(lanes));
      low = lanes < low ? lanes : low;
      high = lanes > high ? lanes : high;
    }
    asking.box.low_m[axis] = -largest_of<kLanes>(-low);
    asking.box.high_m[axis] = largest_of<kLanes>(high);
  }
}

// Those who ask, in registers.
template <std::uint32_t kLanes>
struct Askers {
  static constexpr std::uint32_t kRegisters = kMostLanes / kLanes;
  using Floats = typename Register<kLanes>::Floats;
  using Ints = typename Register<kLanes>::Ints;

  std::array<Floats, kRegisters> x, y, z, square_m2;
  std::array<Ints, kRegisters> number;

  [[gnu::always_inline]] explicit Askers(const AskingPoints& asking) {
    std::memcpy(x.data(), asking.rounded_m[0].data(), sizeof(x));
    std::memcpy(y.data(), asking.rounded_m[1].data(), sizeof(y));
    std::memcpy(z.data(), asking.rounded_m[2].data(), sizeof(z));
    std::memcpy(square_m2.data(), asking.square_m2.data(), sizeof(asking.square_m2));
    std::memcpy(number.data(), asking.number.data(), sizeof(asking.number));
  }
  [[gnu::always_inline]] void store(AskingPoints& asking) const {
    std::memcpy(asking.square_m2.data(), square_m2.data(), sizeof(asking.square_m2));
    std::memcpy(asking.number.data(), number.data(), sizeof(asking.number));
  }
  [[nodiscard, gnu::always_inline]] float farthest_m2() const {
    Floats most = square_m2[0];
    for (std::uint32_t r = 1; r < kRegisters; ++r) most = square_m2[r] > most ? square_m2[r] : most;
    return largest_of<kLanes>(most);
  }
  // Whether a box may hold something nearer for any of them.
  [[nodiscard, gnu::always_inline]] bool may_find_in(const ClusterGroup& boxes, std::size_t k) const {
    Ints any{};
    for (std::uint32_t r = 0; r < kRegisters; ++r) {
      Floats gap_m2{};
      add_square_gap<kLanes>(boxes.low_m[0][k] - x[r], x[r] - boxes.high_m[0][k], gap_m2);
      add_square_gap<kLanes>(boxes.low_m[1][k] - y[r], y[r] - boxes.high_m[1][k], gap_m2);
      add_square_gap<kLanes>(boxes.low_m[2][k] - z[r], z[r] - boxes.high_m[2][k], gap_m2);
      any |= kRoundedDown * gap_m2 <= square_m2[r] ? Ints{} - 1 : Ints{};
    }
    return any_of<kLanes>(any) != 0;
  }
  [[gnu::always_inline]] void look_at(const ClusteredPoints& points, std::uint32_t i) {
    const Ints none = Ints{} + ClusteredPoints::kNoNumber;
    for (std::uint32_t r = 0; r < kRegisters; ++r) {
      const Floats dx = points.x[i] - x[r];
      const Floats dy = points.y[i] - y[r];
      const Floats dz = points.z[i] - z[r];
      const Floats found_m2 = dx * dx + dy * dy + dz * dz;
      const Ints found = Ints{} + points.number[i];
      const Floats least_m2 = found_m2 < square_m2[r] ? found_m2 : square_m2[r];
      const Ints new_one = found_m2 == least_m2 ? found : none;
      const Ints old_one = square_m2[r] == least_m2 ? number[r] : none;
      number[r] = new_one < old_one ? new_one : old_one;
      square_m2[r] = least_m2;
    }
  }
};

// First what touches their box, so that little is left to look for in the rest.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void scan(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                        AskingPoints& asking) {
  std::array<AskingPoints::Floats, kMostGroups> gaps_m2;
  std::array<std::uint32_t, kMostGroups> touching;
  Askers<kLanes> askers(asking);
  float within_m2 = asking.farthest_m2;
  for (std::size_t first = 0; first < groups.size(); first += kMostGroups) {
    const std::span<const ClusterGroup> part = groups.subspan(first, std::min(kMostGroups, groups.size() - first));
    for (std::size_t g = 0; g < part.size(); ++g) gaps_to<kLanes>(part[g], 0, asking.box, gaps_m2[g]);
    const auto look_at = [&](std::size_t g, std::uint32_t clusters) {
      for (; clusters != 0; clusters &= clusters - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(clusters));
        if (gaps_m2[g][k] > within_m2 || !askers.may_find_in(part[g], k)) continue;
        for (std::uint32_t i = part[g].first[k]; i < part[g].end[k]; ++i) askers.look_at(points, i);
        within_m2 = askers.farthest_m2();
      }
    };
    for (std::size_t g = 0; g < part.size(); ++g) {
      touching[g] = gaps_within<kLanes>(gaps_m2[g], 0.0F);
      look_at(g, touching[g]);
    }
    for (std::size_t g = 0; g < part.size(); ++g) {
      look_at(g, gaps_within<kLanes>(gaps_m2[g], within_m2) & ~touching[g]);
    }
  }
  askers.store(asking);
  asking.farthest_m2 = within_m2;
}

// The kernels of registers of so many lanes, for the processors that `target` names.
#define KILTER_MANY_SEARCH(path, lanes, target)                                                                        \
  target void pick_##path(const ClusterBoxes& boxes, std::uint32_t first, std::uint32_t end, const FloatBox& box,      \
                          float above_m2, float at_most_m2, std::vector<ClusterGroup>& groups) {                       \
    pick<lanes>(boxes, first, end, box, above_m2, at_most_m2, groups);                                                 \
  }                                                                                                                    \
  target void move_##path(const Eigen::Isometry3d& T, AskingPoints& asking) { move<lanes>(T, asking); }                \
  target void scan_##path(const ClusteredPoints& points, std::span<const ClusterGroup> groups, AskingPoints& asking) { \
    scan<lanes>(points, groups, asking);                                                                               \
  }                                                                                                                    \
  constexpr ManySearchKernels kernels_##path = {pick_##path, move_##path, scan_##path};

KILTER_MANY_SEARCH(baseline, 4, )
#if defined(__x86_64__)
KILTER_MANY_SEARCH(avx2, 8, [[gnu::target("avx2,bmi")]])
KILTER_MANY_SEARCH(avx512, 16, [[gnu::target("avx512f,bmi")]])
#endif

}  // namespace

ManySearchKernels many_search_kernels(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return kernels_avx512;
  if (path == VectorPath::kAvx2) return kernels_avx2;
#else
  static_cast<void>(path);
#endif
  return kernels_baseline;
}

}  // namespace kilter
