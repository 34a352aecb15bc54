// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kilter {

/// Text as one cell: quoted after RFC 4180 where it must be. Names come from folders of strangers, and spreadsheets
/// run what begins with = + - @, a tab or a carriage return: such text gets a leading apostrophe.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// The shortest number that reads back to the same double; empty when absent or not finite.
[[nodiscard]] std::string csv_cell(std::optional<double> number);

}  // namespace kilter
