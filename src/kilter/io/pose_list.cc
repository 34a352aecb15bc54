// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_list.h"

#include <algorithm>
#include <array>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_reader.h"

namespace kilter {
namespace {

// Blanks and commas separate, as in pose_reader.h; what follows a '#' is a comment.
std::string_view first_word(std::string_view line) {
  line = line.substr(0, line.find('#'));
  return take_word<Separators::kBlanksAndCommas>(line);
}

// How many words a line has, all numbers; 0 if one is none.
std::size_t count_numbers(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::size_t count = 0;
  for (auto word = take_word<Separators::kBlanksAndCommas>(line); !word.empty();
       word = take_word<Separators::kBlanksAndCommas>(line), ++count) {
    if (!parse_real(word)) return 0;
  }
  return count;
}

bool is_graph_tag(std::string_view word) {
  constexpr std::array<std::string_view, 4> kTags = {"VERTEX_", "EDGE_", "PARAMS_", "FIX"};
  return std::any_of(kTags.begin(), kTags.end(), [&](std::string_view tag) { return word.starts_with(tag); });
}

// "t x y z qx qy qz qw" tells nothing that the number of columns does not; and rows without a heading may have
// comments behind them, and stamps below zero.
bool is_order_of_tum(const PoseColumns& columns) {
  constexpr std::array<std::size_t, 7> kPose = {1, 2, 3, 4, 5, 6, 7};
  return columns.count == 8 && columns.stamp == 0 && !columns.unit && std::ranges::equal(columns.pose, kPose);
}

// A heading may stand in a comment: "# timestamp [ns], p_RS_R_x [m], ...".
bool have_heading_of(std::span<const std::string_view> comments, std::string_view row) {
  const std::optional<PoseColumns> columns = heading_in_comments(comments, row);
  return columns && !is_order_of_tum(*columns);
}

// Whether the first line that is no comment begins with a word: a heading, if anything.
bool is_worded(std::string_view bytes) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    const std::string_view word = first_word(*line);
    if (!word.empty()) return !parse_real(word);
  }
  return false;
}

PoseList from_graph(const std::vector<NumberedPose>& vertices) {
  PoseList list;
  list.layout = PoseLayout::kG2o;
  for (const NumberedPose& vertex : vertices) {
    list.ids.push_back(vertex.id);
    list.T_world_cloud.push_back(vertex.T_world_cloud);
  }
  return list;
}

// The first words of a TUM file; none at all if one is no stamp (they may be negative, or just zeros).
std::vector<StampText> stamps_of_rows(std::string_view bytes) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::vector<StampText> stamps;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    const std::string_view word = first_word(*line);
    if (word.empty()) continue;
    const std::optional<StampText> stamp = parse_stamp_text(word);
    if (!stamp) return {};
    stamps.push_back(*stamp);
  }
  return stamps;
}

Expected<PoseList> read_rows(std::string_view bytes, PoseLayout layout, const std::string& where) {
  auto poses = read_poses(bytes, where);
  if (!poses) return pass_up(poses.error());
  PoseList list;
  list.layout = layout;
  list.T_world_cloud = *std::move(poses);
  if (layout == PoseLayout::kTum) list.stamps = stamps_of_rows(bytes);
  return list;
}

}  // namespace

std::string_view name_of(PoseLayout layout) {
  constexpr std::array<std::string_view, 4> kNames = {"TUM (t x y z qx qy qz qw)", "KITTI (12 columns)", "g2o",
                                                      "a table with a heading"};
  return kNames[static_cast<std::size_t>(layout)];
}

std::optional<PoseLayout> guess_pose_layout(std::string_view bytes) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::vector<std::string_view> comments;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    const std::string_view word = first_word(*line);
    if (word.empty() || word.starts_with('%')) {
      const bool is_comment = line->starts_with('#') || line->starts_with('%');
      if (is_comment && comments.size() < kMostComments) comments.push_back(*line);
      continue;
    }
    if (is_graph_tag(word)) return PoseLayout::kG2o;
    if (have_heading_of(comments, *line)) return PoseLayout::kTable;
    const std::size_t numbers = count_numbers(*line);
    if (numbers == 8) return PoseLayout::kTum;
    if (numbers == 12) return PoseLayout::kKitti;
    if (numbers == 0 && parse_heading(*line)) return PoseLayout::kTable;
    return std::nullopt;
  }
  return std::nullopt;
}

Expected<PoseList> read_pose_list(std::string_view bytes, const std::string& where) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return fail(ErrorCode::kParse, "this is UTF-16 text, as PowerShell's > writes it", where, "save it as UTF-8");
  }
  const PoseLayout layout = guess_pose_layout(bytes).value_or(is_worded(bytes) ? PoseLayout::kTable : PoseLayout::kTum);
  if (layout == PoseLayout::kTum || layout == PoseLayout::kKitti) return read_rows(bytes, layout, where);
  if (layout == PoseLayout::kG2o) {
    const auto vertices = read_g2o_vertices(bytes, where);
    if (!vertices) return pass_up(vertices.error());
    return from_graph(*vertices);
  }
  auto table = read_pose_table(bytes, where);
  if (!table) return pass_up(table.error());
  PoseList list;
  static_cast<PoseTable&>(list) = *std::move(table);
  list.layout = PoseLayout::kTable;
  return list;
}

StampUnit stamp_unit_of(const PoseTable& poses) { return poses.unit.value_or(guess_unit(poses.stamps)); }

std::optional<std::vector<std::int64_t>> stamps_ns_of(const PoseTable& poses) {
  if (poses.stamps.empty()) return std::nullopt;
  return to_nanoseconds(poses.stamps, stamp_unit_of(poses));
}

}  // namespace kilter
