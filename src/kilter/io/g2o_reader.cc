// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/g2o_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_numbers.h"

namespace kilter {
namespace {

constexpr std::string_view kVertex = "VERTEX_SE3:QUAT";
constexpr std::string_view kLayout = "a vertex is `VERTEX_SE3:QUAT id x y z qx qy qz qw`";

// What stands behind the tag of a vertex's line.
Expected<NumberedPose> parse_vertex(std::string_view line) {
  NumberedPose vertex;
  const std::string_view id_word = take_word(line);
  const std::optional<std::uint64_t> id = parse_count(id_word);
  if (!id) {
    return fail(ErrorCode::kParse,
                fmt::format("column 2: expected the vertex's id, a whole number, found \"{}\"", printable(id_word, 40)),
                {}, std::string(kLayout));
  }
  std::array<double, 7> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = take_word(line);
    const std::optional<double> value = parse_real(word);
    if (!value) {
      return fail(ErrorCode::kParse,
                  fmt::format("column {}: expected a number, found \"{}\"", i + 3, printable(word, 40)), {},
                  std::string(kLayout));
    }
    values[i] = *value;
  }
  if (const std::string_view more = take_word(line); !more.empty()) {
    return fail(ErrorCode::kParse, fmt::format("expected 9 columns, found more: \"{}\"", printable(more, 40)), {},
                std::string(kLayout));
  }
  if (auto ok = check_finite_columns(values, 3); !ok) return pass_up(ok.error());
  const Expected<Pose3> pose =
      pose_from_quaternion({values[0], values[1], values[2]}, {values[3], values[4], values[5], values[6]});
  if (!pose) return pass_up(pose.error());
  return NumberedPose{*id, *pose};
}

// The name of a submap, ROBOT/N, if that is all that a line's comment holds.
std::optional<std::string_view> submap_name_in(std::string_view line) {
  std::string_view text = line.substr(std::min(line.find('#'), line.size()));
  if (!text.starts_with("# ")) return std::nullopt;
  text.remove_prefix(2);
  const std::size_t slash = text.rfind('/');
  if (slash == std::string_view::npos || slash == 0 || !parse_count(text.substr(slash + 1))) return std::nullopt;
  if (text.find(" <- ") != std::string_view::npos) return std::nullopt;  // an edge's two
  return text;
}

struct PlacedVertex {
  NumberedPose vertex;
  std::size_t line = 0;
};

// In order of ids; of two with one id the later line is named.
Expected<void> sort_by_id(std::vector<PlacedVertex>& vertices, const std::string& where) {
  std::stable_sort(vertices.begin(), vertices.end(),
                   [](const auto& a, const auto& b) { return a.vertex.id < b.vertex.id; });
  const auto twice = std::adjacent_find(vertices.begin(), vertices.end(),
                                        [](const auto& a, const auto& b) { return a.vertex.id == b.vertex.id; });
  if (twice == vertices.end()) return {};
  return fail(ErrorCode::kParse,
              fmt::format("vertex {} is given twice, first in line {}", twice->vertex.id, twice->line),
              fmt::format("{}:{}", where, std::next(twice)->line));
}

tl::unexpected<Error> refuse_without_vertices(bool planar, const std::string& where) {
  if (planar) {
    return fail(ErrorCode::kUnsupported, "the graph is planar (VERTEX_SE2); expected VERTEX_SE3:QUAT", where,
                "write poses in space: clouds cannot be placed by x, y and heading alone");
  }
  return fail(ErrorCode::kEmptyInput, "the file holds no VERTEX_SE3:QUAT", where, std::string(kLayout));
}

}  // namespace

Expected<std::vector<NumberedPose>> read_g2o_vertices(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::vector<PlacedVertex> placed;
  bool planar = false;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = line->substr(0, line->find('#'));
    const std::string_view tag = take_word(rest);
    planar = planar || tag == "VERTEX_SE2";
    if (tag != kVertex) continue;
    Expected<NumberedPose> vertex = parse_vertex(rest);
    if (!vertex) {
      vertex.error().where = fmt::format("{}:{}", where, cursor.line());
      return pass_up(std::move(vertex.error()));
    }
    placed.push_back({*vertex, cursor.line()});
  }
  if (placed.empty()) return refuse_without_vertices(planar, where);
  if (auto ok = sort_by_id(placed, where); !ok) return pass_up(ok.error());
  std::vector<NumberedPose> vertices;
  vertices.reserve(placed.size());
  for (const PlacedVertex& each : placed) vertices.push_back(each.vertex);
  return vertices;
}

std::map<std::uint64_t, std::string> g2o_vertex_names(std::string_view bytes) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::map<std::uint64_t, std::string> names;
  std::optional<std::string_view> above;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = line->substr(0, line->find('#'));
    const std::optional<std::string_view> beside = submap_name_in(*line);
    if (take_word(rest) == kVertex) {
      const std::optional<std::uint64_t> id = parse_count(take_word(rest));
      const std::optional<std::string_view> name = beside ? beside : above;
      if (id && name) names.emplace(*id, *name);
      above.reset();
    } else {
      above = line->starts_with('#') ? beside : std::nullopt;
    }
  }
  return names;
}

}  // namespace kilter
