// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kilter/base/expected.h"

namespace kilter {

/// Where bytes lie in a SpillSpace.
struct SpillPlace {
  std::uint64_t offset = 0;
  std::size_t size = 0;
};

/// Room outside of memory for what does not fit in: bytes go there once and are read as often as needed. Lives as long
/// as the run; `io` has one in a temporary file. Any thread may call.
class SpillSpace {
 public:
  SpillSpace() = default;
  SpillSpace(const SpillSpace&) = delete;
  SpillSpace(SpillSpace&&) = delete;
  SpillSpace& operator=(const SpillSpace&) = delete;
  SpillSpace& operator=(SpillSpace&&) = delete;
  virtual ~SpillSpace() = default;

  /// \return where they lie now; or kNoSpace, kIo.
  [[nodiscard]] virtual Expected<SpillPlace> write(std::span<const std::byte> bytes) = 0;
  /// Fills `bytes` with what was written at a place of this size. \return kTruncated, kIo.
  [[nodiscard]] virtual Expected<void> read(const SpillPlace& place, std::span<std::byte> bytes) = 0;
};

}  // namespace kilter
