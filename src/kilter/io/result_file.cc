// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/result_file.h"

#include <fmt/format.h>

#include <string>
#include <system_error>

#include "kilter/io/file.h"

namespace kilter {

namespace fs = std::filesystem;

Expected<fs::path> find_result_file(const fs::path& result, std::string_view name, std::string_view takes) {
  Expected<fs::file_type> type = type_at(result);
  if (!type) {
    if (type.error().hint.empty()) type.error().hint = takes;
    return pass_up(std::move(type.error()));
  }
  if (*type != fs::file_type::directory) return result;
  std::error_code error;
  if (fs::exists(result / name, error) || error) return result / name;
  return fail(ErrorCode::kNotFound, fmt::format("expected the folder of a result, found no {} in it", name),
              shown(result), std::string(takes));
}

}  // namespace kilter
