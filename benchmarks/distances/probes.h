// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace kilter {

// What the machine can do at best, for a floor under look-ups. Processor time of one thread, least of some rounds.

// Additions that wait for each other, one a cycle. [1/ns]
[[nodiscard]] double cycles_per_ns();

// Reads of lines in random order that do not wait for each other, in memory of so many bytes. [ns a line]
[[nodiscard]] double random_line_ns(std::size_t bytes);

// Reading such memory from front to back. [ns a byte]
[[nodiscard]] double sequential_byte_ns(std::size_t bytes);

}  // namespace kilter
