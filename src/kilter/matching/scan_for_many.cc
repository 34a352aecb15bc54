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

// The gaps between the box of those who ask and the boxes of a group. [m^2]
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void gaps_to(const ClusterGroup& group, const FloatBox& box,
                                           AskingPoints::Floats& gaps_m2) {
  for (std::uint32_t from = 0; from < kMostLanes; from += kLanes) {
    typename Register<kLanes>::Floats gaps;
    square_gaps<kLanes>(group, from, box.low_m.data(), box.high_m.data(), gaps);
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

// Those who ask, in registers.
template <std::uint32_t kLanes>
struct Askers {
  static constexpr std::uint32_t kRegisters = kMostLanes / kLanes;
  using Floats = typename Register<kLanes>::Floats;
  using Ints = typename Register<kLanes>::Ints;

  std::array<Floats, kRegisters> x, y, z, square_m2;
  std::array<Ints, kRegisters> number;

  [[gnu::always_inline]] explicit Askers(const AskingPoints& asking) {
    std::memcpy(x.data(), asking.x.data(), sizeof(asking.x));
    std::memcpy(y.data(), asking.y.data(), sizeof(asking.y));
    std::memcpy(z.data(), asking.z.data(), sizeof(asking.z));
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
  [[nodiscard, gnu::always_inline]] bool may_find_in(const ClusterGroup& group, std::size_t k) const {
    Ints any{};
    for (std::uint32_t r = 0; r < kRegisters; ++r) {
      Floats gap_m2{};
      add_square_gap<kLanes>(group.low_m[0][k] - x[r], x[r] - group.high_m[0][k], gap_m2);
      add_square_gap<kLanes>(group.low_m[1][k] - y[r], y[r] - group.high_m[1][k], gap_m2);
      add_square_gap<kLanes>(group.low_m[2][k] - z[r], z[r] - group.high_m[2][k], gap_m2);
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
    for (std::size_t g = 0; g < part.size(); ++g) gaps_to<kLanes>(part[g], asking.box, gaps_m2[g]);
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

void scan_baseline(const ClusteredPoints& points, std::span<const ClusterGroup> groups, AskingPoints& asking) {
  scan<4>(points, groups, asking);
}

#if defined(__x86_64__)
[[gnu::target("avx2,bmi")]] void scan_avx2(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                           AskingPoints& asking) {
  scan<8>(points, groups, asking);
}

[[gnu::target("avx512f,bmi")]] void scan_avx512(const ClusteredPoints& points, std::span<const ClusterGroup> groups,
                                                AskingPoints& asking) {
  scan<16>(points, groups, asking);
}
#endif

}  // namespace

ScanForMany scan_for_many_with(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return scan_avx512;
  if (path == VectorPath::kAvx2) return scan_avx2;
#else
  static_cast<void>(path);
#endif
  return scan_baseline;
}

}  // namespace kilter
