// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/log_from_files.h"

#include <algorithm>
#include <memory>

#include "kilter/base/contract.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/octree_reader.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view stem_of(std::string_view name) { return name.substr(0, name.rfind('.')); }

}  // namespace

std::optional<std::uint64_t> number_of_file(std::string_view name) { return parse_count(stem_of(name)); }

std::optional<std::vector<std::uint64_t>> numbers_of_files(std::span<const std::string> names) {
  if (names.empty()) return std::nullopt;
  if (names.size() == 1) {
    const auto number = number_of_file(names.front());
    return number ? std::optional(std::vector{*number}) : std::nullopt;
  }
  std::string_view before = stem_of(names.front());
  std::string_view behind = before;
  for (const std::string& file : names) {
    const std::string_view name = stem_of(file);
    const auto differ = std::mismatch(before.begin(), before.end(), name.begin(), name.end()).first;
    before = before.substr(0, static_cast<std::size_t>(differ - before.begin()));
    const auto differ_behind = std::mismatch(behind.rbegin(), behind.rend(), name.rbegin(), name.rend()).first;
    behind = behind.substr(behind.size() - static_cast<std::size_t>(differ_behind - behind.rbegin()));
  }
  // Digits that all numbers share are theirs, too.
  while (!before.empty() && is_digit(before.back())) before.remove_suffix(1);
  while (!behind.empty() && is_digit(behind.front())) behind.remove_prefix(1);
  if (before.ends_with('.')) return std::nullopt;  // 5.12 is no more than 5.2
  std::vector<std::uint64_t> numbers;
  for (const std::string& file : names) {
    const std::string_view name = stem_of(file);
    if (name.size() < before.size() + behind.size()) return std::nullopt;
    const auto number = parse_count(name.substr(before.size(), name.size() - before.size() - behind.size()));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

void read_from_files(RobotLog& log, std::vector<fs::path> paths) {
  const auto files = std::make_shared<const std::vector<fs::path>>(std::move(paths));
  log.read_cloud = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return read_cloud_file((*files)[i]);
  };
  log.peek_cloud = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return peek_cloud_file((*files)[i]);
  };
  log.cloud_name = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return shown((*files)[i]);
  };
}

Expected<void> read_from_octrees(RobotLog& log, std::vector<fs::path> paths) {
  KILTER_EXPECTS(!paths.empty());
  const Expected<double> cell_size_m = read_octree_resolution_m(paths.front());
  if (!cell_size_m) return pass_up(cell_size_m.error());
  log.cell_size_m = *cell_size_m;
  read_from_files(log, paths);  // for the names
  const auto files = std::make_shared<const std::vector<fs::path>>(std::move(paths));
  log.read_cells = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return read_octree_file((*files)[i]);
  };
  log.read_cloud = [read_cells = log.read_cells](std::size_t i) -> Expected<PointCloud> {
    const Expected<OccupancyCells> known = read_cells(i);
    if (!known) return pass_up(known.error());
    return occupied_centres(*known);
  };
  return {};
}

}  // namespace kilter
