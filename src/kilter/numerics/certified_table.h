// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace kilter {

/// Rows of a committed table (tests only): comma-separated, '#' lines and the line of column names left out.
[[nodiscard]] inline std::vector<std::vector<std::string>> load_certified(const std::string& name) {
  std::ifstream file(std::string(KILTER_NUMERICS_TESTDATA) + "/" + name);
  std::vector<std::vector<std::string>> rows;
  bool names_seen = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    if (!names_seen) {
      names_seen = true;
      continue;
    }
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

/// Nearest double of a cell; 0 where the value is below the range of double.
[[nodiscard]] inline double number_of(const std::string& cell) { return std::strtod(cell.c_str(), nullptr); }

}  // namespace kilter
