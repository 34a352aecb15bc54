// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/numbered_folders.h"

#include <algorithm>
#include <fstream>

#include "kilter/io/file.h"
#include "kilter/io/number_text.h"

namespace kilter {
namespace {

bool is_number_name(std::string_view name) {
  constexpr std::size_t kFewestDigits = 6;
  return name.size() >= kFewestDigits &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
         parse_count(name).has_value();
}

}  // namespace

Expected<std::vector<std::string>> list_numbered_folders(const std::filesystem::path& folder, std::string_view inside) {
  auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  std::erase_if(*names,
                [&](const std::string& name) { return !is_number_name(name) || !is_file(folder / name / inside); });
  // Bytewise, "1000000" would come before "999999".
  std::stable_sort(names->begin(), names->end(),
                   [](const auto& a, const auto& b) { return parse_count(a) < parse_count(b); });
  return *std::move(names);
}

std::string first_bytes(const std::filesystem::path& file, std::size_t count) {
  if (!is_file(file)) return {};  // a pipe would make us wait
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(count, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

}  // namespace kilter
