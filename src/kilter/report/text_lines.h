// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kilter {

/// Characters that `text` takes on a terminal, one per code point. Precondition: UTF-8 without controls.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// At most `columns` of the text; what is cut away is shown as "~", at the end.
[[nodiscard]] std::string cut_end(std::string_view text, std::size_t columns);

/// The same, cut at the front: of a submap's name the number behind is what matters.
[[nodiscard]] std::string cut_front(std::string_view text, std::size_t columns);

/// Padded with blanks behind to `columns`.
[[nodiscard]] std::string padded(std::string text, std::size_t columns);

/// Breaks text at blanks into at most `max_lines` lines of at most `columns`; lines after the first start with
/// `indent` blanks; what does not fit is cut.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::size_t indent,
                                               std::size_t max_lines);

/// Text as one word of a POSIX shell, for commands that are there to be copied: in single quotes where it must be.
[[nodiscard]] std::string shell_word(std::string_view text);

}  // namespace kilter
