// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/text_lines.h"

#include <algorithm>
#include <utility>

namespace kilter {
namespace {

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

// Byte at which character number `count` begins.
std::size_t byte_of(std::string_view text, std::size_t count) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (begins_character(text[i]) && count-- == 0) return i;
  }
  return text.size();
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins_character));
}

std::string cut_end(std::string_view text, std::size_t columns) {
  if (columns_of(text) <= columns) return std::string(text);
  return columns == 0 ? "" : std::string(text.substr(0, byte_of(text, columns - 1))) + '~';
}

std::string cut_front(std::string_view text, std::size_t columns) {
  const std::size_t has = columns_of(text);
  if (has <= columns) return std::string(text);
  return columns == 0 ? "" : '~' + std::string(text.substr(byte_of(text, has - columns + 1)));
}

std::string padded(std::string text, std::size_t columns) {
  const std::size_t has = columns_of(text);
  if (has < columns) text.append(columns - has, ' ');
  return text;
}

std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::size_t indent,
                                 std::size_t max_lines) {
  std::vector<std::string> lines;
  std::string line;
  std::size_t words = 0;  // in `line`
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    if (words > 0 && columns_of(line) + 1 + columns_of(word) > columns) {
      if (lines.size() + 1 == max_lines) {
        lines.push_back(cut_end(line + ' ' + std::string(text), columns));
        return lines;
      }
      lines.push_back(std::exchange(line, std::string(indent, ' ')));
      words = 0;
    }
    if (words++ > 0) line += ' ';
    line += word;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (words > 0) lines.push_back(cut_end(line, columns));
  return lines;
}

std::string shell_word(std::string_view text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:=@%";
  const auto is_plain = [&](char c) { return (c & 0x80) != 0 || kPlain.find(c) != std::string_view::npos; };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace kilter
