// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace kilter {

/// A register of so many lanes of 32 bits, or half as many of 64. Functions that are templates of the number are
/// written once; each caller's target decides which instructions they become. (g++ 12 takes the size of a vector from
/// no template's argument.)
template <std::uint32_t kLanes>
struct Register;
template <>
struct Register<4> {
  using Floats = float __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
  using Doubles = double __attribute__((vector_size(16)));
  using HalfFloats = float __attribute__((vector_size(8)));
};
template <>
struct Register<8> {
  using Floats = float __attribute__((vector_size(32)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
  using Doubles = double __attribute__((vector_size(32)));
  using HalfFloats = float __attribute__((vector_size(16)));
};
template <>
struct Register<16> {
  using Floats = float __attribute__((vector_size(64)));
  using Ints = std::int32_t __attribute__((vector_size(64)));
  using Doubles = double __attribute__((vector_size(64)));
  using HalfFloats = float __attribute__((vector_size(32)));
};

/// A bit for each lane of the widest register.
inline constexpr std::array<std::int32_t, 16> kLaneBits = {1 << 0,  1 << 1,  1 << 2,  1 << 3, 1 << 4,  1 << 5,
                                                           1 << 6,  1 << 7,  1 << 8,  1 << 9, 1 << 10, 1 << 11,
                                                           1 << 12, 1 << 13, 1 << 14, 1 << 15};

/// The number of each.
inline constexpr std::array<std::int32_t, 16> kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/// Whichever of the bits are set in any lane.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline std::uint32_t any_of(const typename Register<kLanes>::Ints& lanes) {
  if constexpr (kLanes > 4) {
    std::array<typename Register<kLanes / 2>::Ints, 2> halves{};
    std::memcpy(halves.data(), &lanes, sizeof(lanes));
    return any_of<kLanes / 2>(halves[0] | halves[1]);
  } else {
    return static_cast<std::uint32_t>(lanes[0] | lanes[1] | lanes[2] | lanes[3]);
  }
}

/// The largest of the lanes.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline float largest_of(const typename Register<kLanes>::Floats& lanes) {
  if constexpr (kLanes > 4) {
    std::array<typename Register<kLanes / 2>::Floats, 2> halves{};
    std::memcpy(halves.data(), &lanes, sizeof(lanes));
    return largest_of<kLanes / 2>(halves[0] > halves[1] ? halves[0] : halves[1]);
  } else {
    const typename Register<4>::Floats turned = __builtin_shufflevector(lanes, lanes, 2, 3, 0, 1);
    const typename Register<4>::Floats pairs = lanes > turned ? lanes : turned;
    return pairs[0] > pairs[1] ? pairs[0] : pairs[1];
  }
}

}  // namespace kilter
