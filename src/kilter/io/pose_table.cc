// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_numbers.h"

namespace kilter {
namespace {

constexpr std::array<std::string_view, 7> kPoseColumns = {"x", "y", "z", "qx", "qy", "qz", "qw"};

// '*' stands for an axis. A name with "_" in it may have more in front: "field.pose.pose.position.x".
constexpr std::array<std::string_view, 9> kPositions = {
    "*", "t*", "p*", "t_*", "p_*", "pos_*", "position_*", "translation_*", "p_rs_r_*"};
constexpr std::array<std::string_view, 8> kRotations = {
    "q*", "q_*", "quat_*", "quaternion_*", "orientation_*", "rotation_*", "rot_*", "q_rs_*"};
constexpr std::array<std::string_view, 8> kStamps = {"t",  "time", "stamp",   "timestamp",
                                                     "ts", "secs", "seconds", "header_stamp"};
constexpr std::array<std::string_view, 11> kFiles = {"file", "filename", "file_name",  "filepath", "file_path", "path",
                                                     "name", "cloud",    "cloud_file", "pcd",      "scan"};

// A heading's cell: its name as it is compared, and the unit behind it in brackets.
struct ColumnName {
  std::string name;
  std::string unit;
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\"'#%";
  const std::size_t first = text.find_first_not_of(kAround);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kAround) - first + 1);
}

ColumnName parse_column_name(std::string_view cell) {
  ColumnName column;
  const std::size_t bracket = cell.find_first_of("[(");
  if (bracket != std::string_view::npos) {
    column.unit = lower_case(cell.substr(bracket + 1, cell.find_first_of("])", bracket) - bracket - 1));
  }
  column.name = lower_case(trimmed(cell.substr(0, bracket)));
  std::replace_if(
      column.name.begin(), column.name.end(), [](char c) { return c == '.' || c == '/' || c == '-' || c == ' '; }, '_');
  return column;
}

// The next cell of a line; a separator other than blanks may have nothing between two of it.
std::string_view take_cell(std::string_view& line, char separator) {
  if (separator == ' ') return take_word(line);
  const std::size_t end = std::min(line.find(separator), line.size());
  const std::string_view cell = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return cell;
}

// All cells of a line; empty ones at its end are left out, as some writers end each line with a separator.
std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  while (!line.empty()) cells.push_back(trimmed(take_cell(line, separator)));
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

char separator_of(std::string_view heading) {
  for (const char separator : {',', ';', '\t'}) {
    if (heading.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

// Without copies: a hostile heading may have a million cells.
bool fits(std::string_view name, std::string_view pattern, char axis) {
  if (name.size() < pattern.size()) return false;
  const std::string_view end = name.substr(name.size() - pattern.size());
  const auto same = [axis](char found, char wanted) { return found == (wanted == '*' ? axis : wanted); };
  if (!std::equal(end.rbegin(), end.rend(), pattern.rbegin(), same)) return false;
  if (name.size() == pattern.size()) return true;
  return pattern.find('_') != std::string_view::npos && pattern.size() > 4 &&
         name[name.size() - pattern.size() - 1] == '_';
}

template <std::size_t n>
bool fits_any(std::string_view name, const std::array<std::string_view, n>& patterns, char axis = '*') {
  return std::any_of(patterns.begin(), patterns.end(), [&](std::string_view each) { return fits(name, each, axis); });
}

// Which of x y z qx qy qz qw a column is.
std::optional<std::size_t> place_in_pose(std::string_view name) {
  constexpr std::string_view kAxes = "xyzw";
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (axis < 3 && fits_any(name, kPositions, kAxes[axis])) return axis;
    if (fits_any(name, kRotations, kAxes[axis])) return 3 + axis;
  }
  return std::nullopt;
}

// "time", "timestamp_ns": the name without its unit.
std::string_view without_unit(std::string_view name) {
  for (const std::string_view unit : {"_nsec", "_nanosec", "_sec", "_ns", "_us", "_ms", "_s"}) {
    if (name.ends_with(unit)) return name.substr(0, name.size() - unit.size());
  }
  return name;
}

// "header_stamp_secs" is the part "secs" of "header_stamp".
std::pair<std::string_view, std::string_view> whole_and_part(std::string_view name) {
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string_view::npos) return {{}, name};
  return {name.substr(0, underscore), name.substr(underscore + 1)};
}

constexpr std::array<std::string_view, 3> kSecondsParts = {"sec", "secs", "seconds"};
constexpr std::array<std::string_view, 5> kNanosecondsParts = {"nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"};

template <std::size_t n>
std::optional<std::size_t> find_part(const std::vector<std::string>& names,
                                     const std::array<std::string_view, n>& parts) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return std::find(parts.begin(), parts.end(), whole_and_part(name).second) != parts.end();
  });
  return found == names.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - names.begin()));
}

// Where seconds and nanoseconds of one stamp are two columns, they are the stamp.
void take_split_stamp(const std::vector<std::string>& names, PoseColumns& columns) {
  const std::optional<std::size_t> seconds = find_part(names, kSecondsParts);
  const std::optional<std::size_t> nanoseconds = find_part(names, kNanosecondsParts);
  if (!seconds || !nanoseconds) return;
  if (whole_and_part(names[*seconds]).first != whole_and_part(names[*nanoseconds]).first) return;
  columns.stamp = seconds;
  columns.nanoseconds = nanoseconds;
  columns.unit = StampUnit::kSeconds;
}

std::optional<StampUnit> unit_of(const ColumnName& column) {
  const std::string_view suffix =
      column.unit.empty() ? std::string_view(column.name).substr(without_unit(column.name).size()) : column.unit;
  const std::string_view unit = suffix.starts_with('_') ? suffix.substr(1) : suffix;
  if (unit == "ns" || unit == "nsec" || unit == "nanosec") return StampUnit::kNanoseconds;
  if (unit == "us") return StampUnit::kMicroseconds;
  if (unit == "ms") return StampUnit::kMilliseconds;
  if (unit == "s" || unit == "sec") return StampUnit::kSeconds;
  return std::nullopt;
}

std::string missing_columns(const std::array<std::optional<std::size_t>, 7>& places) {
  std::string missing;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", kPoseColumns[i]);
  }
  return missing;
}

Expected<double> parse_cell(const std::vector<std::string_view>& cells, std::size_t column, std::string_view name) {
  if (const std::optional<double> value = parse_real(cells[column])) return *value;
  return fail(ErrorCode::kParse, fmt::format("column {} ({}): expected a number, found \"{}\"", column + 1, name,
                                             printable(cells[column], 40)));
}

Expected<Pose3> parse_pose_cells(const std::vector<std::string_view>& cells, const PoseColumns& columns) {
  std::array<double, 7> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Expected<double> value = parse_cell(cells, columns.pose[i], kPoseColumns[i]);
    if (!value) return pass_up(value.error());
    values[i] = *value;
    if (auto ok = check_finite_columns(std::span(values).subspan(i, 1), columns.pose[i] + 1); !ok) {
      return pass_up(ok.error());
    }
  }
  return pose_from_quaternion({values[0], values[1], values[2]}, {values[3], values[4], values[5], values[6]});
}

Expected<StampText> parse_stamp_cells(const std::vector<std::string_view>& cells, const PoseColumns& columns) {
  const auto refuse = [&](std::size_t column, std::string_view expected) {
    return fail(ErrorCode::kParse, fmt::format("column {}: expected {}, found \"{}\"", column + 1, expected,
                                               printable(cells[column], 40)));
  };
  const std::optional<StampText> stamp = parse_stamp_text(cells[*columns.stamp]);
  if (!stamp) return refuse(*columns.stamp, "a stamp");
  if (!columns.nanoseconds) return *stamp;
  constexpr std::uint64_t kBillion = 1'000'000'000;
  const std::optional<std::uint64_t> nanoseconds = parse_count(cells[*columns.nanoseconds]);
  if (!nanoseconds || *nanoseconds >= kBillion) return refuse(*columns.nanoseconds, "nanoseconds below 1000000000");
  return StampText{stamp->whole, static_cast<std::int64_t>(*nanoseconds), true};
}

Expected<void> add_row(PoseTable& table, std::string_view line, const PoseColumns& columns) {
  const std::vector<std::string_view> cells = cells_of(line, columns.separator);
  if (cells.size() != columns.count) {
    return fail(ErrorCode::kParse,
                fmt::format("expected {} columns as in the heading, found {}", columns.count, cells.size()));
  }
  const Expected<Pose3> pose = parse_pose_cells(cells, columns);
  if (!pose) return pass_up(pose.error());
  table.T_world_cloud.push_back(*pose);
  if (columns.stamp) {
    const Expected<StampText> stamp = parse_stamp_cells(cells, columns);
    if (!stamp) return pass_up(stamp.error());
    table.stamps.push_back(*stamp);
  }
  if (columns.file) {
    const std::string_view file = cells[*columns.file];
    // The name alone: no path that stands in a file is followed.
    table.files.emplace_back(file.substr(file.find_last_of("/\\") + 1));
  }
  return {};
}

// Rows may be cut by another separator than their heading. \return whether the row has as many columns by either
bool take_separator_of(std::string_view row, PoseColumns& columns) {
  if (cells_of(row, columns.separator).size() == columns.count) return true;
  const char own = separator_of(row);
  if (cells_of(row, own).size() != columns.count) return false;
  columns.separator = own;
  return true;
}

bool is_comment(std::string_view line) { return line.starts_with('#') || line.starts_with('%'); }

}  // namespace

Expected<PoseColumns> parse_heading(std::string_view line) {
  PoseColumns columns;
  columns.separator = separator_of(line);
  const std::vector<std::string_view> cells = cells_of(trimmed(line), columns.separator);
  columns.count = cells.size();
  std::array<std::optional<std::size_t>, 7> places;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ColumnName column = parse_column_name(cells[i]);
    names.push_back(column.name);
    if (const auto place = place_in_pose(column.name)) {
      if (places[*place]) {
        return fail(ErrorCode::kParse, fmt::format("columns {} and {} of the heading both mean {}", *places[*place] + 1,
                                                   i + 1, kPoseColumns[*place]));
      }
      places[*place] = i;
    } else if (!columns.stamp && fits_any(without_unit(column.name), kStamps)) {
      columns.stamp = i;
      columns.unit = unit_of(column);
    } else if (!columns.file && fits_any(column.name, kFiles)) {
      columns.file = i;
    }
  }
  if (const std::string missing = missing_columns(places); !missing.empty()) {
    return fail(
        ErrorCode::kParse, fmt::format("the heading names no column for {}: \"{}\"", missing, printable(line, 120)), {},
        "name the columns t, x, y, z, qx, qy, qz, qw; angles (roll, pitch, yaw) are not read. Without a heading, "
        "8 columns are TUM's and 12 KITTI's");
  }
  for (const std::optional<std::size_t>& place : places) columns.pose.push_back(*place);
  take_split_stamp(names, columns);
  return columns;
}

std::optional<PoseColumns> heading_in_comment(std::string_view comment, std::string_view row) {
  const std::size_t colon = comment.rfind(':');
  for (const std::size_t first : {std::size_t{0}, colon == std::string_view::npos ? 0 : colon + 1}) {
    Expected<PoseColumns> columns = parse_heading(comment.substr(first));
    if (columns && take_separator_of(row, *columns)) return *std::move(columns);
  }
  return std::nullopt;
}

std::optional<PoseColumns> heading_in_comments(std::span<const std::string_view> comments, std::string_view row) {
  for (const std::string_view comment : comments) {
    if (std::optional<PoseColumns> columns = heading_in_comment(comment, row)) return columns;
  }
  return std::nullopt;
}

Expected<PoseTable> read_pose_table(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  PoseTable table;
  std::optional<PoseColumns> columns;
  std::vector<std::string_view> comments;  // above the first row
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    if (trimmed(*line).empty()) continue;
    if (is_comment(*line)) {
      if (!columns && comments.size() < kMostComments) comments.push_back(*line);
      continue;
    }
    Expected<void> ok;
    if (!columns) columns = heading_in_comments(comments, *line);
    if (columns) {
      if (table.T_world_cloud.empty()) take_separator_of(*line, *columns);
      ok = add_row(table, *line, *columns);
    } else if (Expected<PoseColumns> heading = parse_heading(*line)) {
      columns = *std::move(heading);
    } else {
      ok = pass_up(heading.error());
    }
    if (!ok) {
      ok.error().where = fmt::format("{}:{}", where, cursor.line());
      return pass_up(std::move(ok.error()));
    }
  }
  if (columns) table.unit = columns->unit;
  if (table.T_world_cloud.empty()) return fail(ErrorCode::kEmptyInput, "the file holds no pose", where);
  return table;
}

}  // namespace kilter
