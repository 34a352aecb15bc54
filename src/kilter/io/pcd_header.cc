// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "kilter/io/number_text.h"

namespace kilter {
namespace {

enum Keyword { kVersion, kFields, kSize, kType, kCount, kWidth, kHeight, kViewpoint, kPoints, kData, kNumKeywords };

constexpr std::array<std::string_view, kNumKeywords> kKeywords = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                                                  "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

// No sensor has that many; a header of megabytes is not a header.
constexpr std::size_t kMaxFields = 1024;

// What stands behind a keyword, and where.
struct HeaderLine {
  std::string_view words;
  std::size_t number = 0;  // 0: not in the file

  [[nodiscard]] bool is_given() const { return number != 0; }
};

using HeaderLines = std::array<HeaderLine, kNumKeywords>;

std::string at_line(const std::string& where, const HeaderLine& line) {
  return line.is_given() ? fmt::format("{}:{}", where, line.number) : where;
}

Expected<HeaderLines> take_header_lines(ByteCursor& bytes, const std::string& where) {
  HeaderLines lines;
  while (!lines[kData].is_given()) {
    const std::optional<std::string_view> line = bytes.take_line();
    if (!line) return fail(ErrorCode::kTruncated, "the file ends before the DATA line of its PCD header", where);
    std::string_view words = *line;
    std::string_view keyword = take_word(words);
    if (keyword.empty() || keyword.front() == '#') continue;
    if (keyword == "COLUMNS") keyword = "FIELDS";  // the older name
    const auto known = std::find(kKeywords.begin(), kKeywords.end(), keyword);
    const std::string place = fmt::format("{}:{}", where, bytes.line());
    if (known == kKeywords.end()) {
      return fail(ErrorCode::kParse, fmt::format("expected a PCD header line, found \"{}\"", printable(keyword, 40)),
                  place, "a PCD header has VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS, DATA");
    }
    HeaderLine& slot = lines[static_cast<std::size_t>(known - kKeywords.begin())];
    if (slot.is_given()) {
      return fail(ErrorCode::kParse, fmt::format("{} is given twice, first in line {}", keyword, slot.number), place);
    }
    slot = {words, bytes.line()};
  }
  return lines;
}

std::vector<std::string_view> split(std::string_view words) {
  std::vector<std::string_view> list;
  for (std::string_view word = take_word(words); !word.empty() && list.size() <= kMaxFields; word = take_word(words)) {
    list.push_back(word);
  }
  return list;
}

// The words of FIELDS, SIZE, TYPE or COUNT: one per field.
Expected<std::vector<std::string_view>> split_per_field(const HeaderLines& lines, Keyword keyword, std::size_t fields,
                                                        const std::string& where) {
  if (!lines[keyword].is_given()) {
    return fail(ErrorCode::kParse, fmt::format("the PCD header has no {} line", kKeywords[keyword]), where);
  }
  std::vector<std::string_view> words = split(lines[keyword].words);
  if (words.size() != fields) {
    return fail(ErrorCode::kParse,
                fmt::format("FIELDS names {} fields, but {} has {} entries", fields, kKeywords[keyword], words.size()),
                at_line(where, lines[keyword]));
  }
  return words;
}

std::optional<ScalarType> scalar_type(std::string_view type, std::string_view size) {
  const std::string key = fmt::format("{}{}", type, size);
  constexpr std::array<std::string_view, 10> kNames = {"I1", "U1", "I2", "U2", "I4", "U4", "I8", "U8", "F4", "F8"};
  const auto found = std::find(kNames.begin(), kNames.end(), key);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<ScalarType>(found - kNames.begin());
}

// Places the field behind the others; nothing if the record's size does not fit 64 bits.
bool append_field(PcdHeader& header, PcdField field) {
  field.first_column = header.columns;
  field.offset = header.record_bytes;
  const auto bytes = checked_product(field.count, size_of(field.type));
  const auto columns = checked_sum(header.columns, field.count);
  const auto record = bytes ? checked_sum(header.record_bytes, *bytes) : std::nullopt;
  if (!columns || !record) return false;
  header.columns = *columns;
  header.record_bytes = *record;
  header.fields.push_back(field);
  return true;
}

Expected<void> read_fields(const HeaderLines& lines, const std::string& where, PcdHeader& header) {
  const std::vector<std::string_view> names = split(lines[kFields].words);
  if (names.size() > kMaxFields) {
    return fail(ErrorCode::kUnsupported, fmt::format("more than {} fields", kMaxFields),
                at_line(where, lines[kFields]));
  }
  const auto sizes = split_per_field(lines, kSize, names.size(), where);
  if (!sizes) return pass_up(sizes.error());
  const auto types = split_per_field(lines, kType, names.size(), where);
  if (!types) return pass_up(types.error());
  std::vector<std::string_view> counts(names.size(), "1");
  if (lines[kCount].is_given()) {
    auto given = split_per_field(lines, kCount, names.size(), where);
    if (!given) return pass_up(given.error());
    counts = *std::move(given);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<ScalarType> type = scalar_type((*types)[i], (*sizes)[i]);
    if (!type) {
      return fail(ErrorCode::kParse,
                  fmt::format("field \"{}\": TYPE {} with SIZE {} is none of I and U with 1, 2, 4, 8 or F with 4, 8",
                              printable(names[i], 40), printable((*types)[i], 40), printable((*sizes)[i], 40)),
                  at_line(where, lines[kType]));
    }
    const std::optional<std::uint64_t> count = parse_count(counts[i]);
    if (!count || !append_field(header, {.name = names[i], .type = *type, .count = *count})) {
      return fail(ErrorCode::kParse,
                  fmt::format("field \"{}\": COUNT is \"{}\", expected a whole number of values per point",
                              printable(names[i], 40), printable(counts[i], 40)),
                  at_line(where, lines[kCount]));
    }
  }
  return {};
}

Expected<void> find_xyz(const HeaderLines& lines, const std::string& where, PcdHeader& header) {
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto is_axis = [&](const PcdField& field) { return field.name == kNames[axis]; };
    const auto found = std::find_if(header.fields.begin(), header.fields.end(), is_axis);
    const auto number = std::count_if(header.fields.begin(), header.fields.end(), is_axis);
    if (number != 1 || found->count != 1) {
      return fail(ErrorCode::kParse,
                  fmt::format("expected exactly one field \"{}\" of one value, found {} in \"FIELDS{}\"", kNames[axis],
                              number == 1 ? fmt::format("COUNT {}", found->count) : fmt::format("{}", number),
                              printable(lines[kFields].words, 120)),
                  at_line(where, lines[kFields]));
    }
    header.xyz[axis] = static_cast<std::size_t>(found - header.fields.begin());
  }
  return {};
}

// The one number of WIDTH, HEIGHT or POINTS; nothing if the line is missing.
Expected<std::optional<std::uint64_t>> read_count(const HeaderLines& lines, Keyword keyword, const std::string& where) {
  if (!lines[keyword].is_given()) return std::nullopt;
  const std::vector<std::string_view> words = split(lines[keyword].words);
  const std::optional<std::uint64_t> count = words.size() == 1 ? parse_count(words[0]) : std::nullopt;
  if (!count) {
    return fail(ErrorCode::kParse,
                fmt::format("{} must be one whole number that is not negative, found \"{}\"", kKeywords[keyword],
                            printable(lines[keyword].words, 40)),
                at_line(where, lines[keyword]));
  }
  return count;
}

Expected<void> read_size(const HeaderLines& lines, const std::string& where, PcdHeader& header) {
  std::array<std::optional<std::uint64_t>, 3> given;
  constexpr std::array<Keyword, 3> kKeys = {kWidth, kHeight, kPoints};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto count = read_count(lines, kKeys[i], where);
    if (!count) return pass_up(count.error());
    given[i] = *count;
  }
  const auto& [width, height, points] = given;
  if (!width && !points) return fail(ErrorCode::kParse, "the PCD header has neither POINTS nor WIDTH", where);
  const auto area = width ? checked_product(*width, height.value_or(1)) : points;
  if (!area || (points && *points != *area)) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("WIDTH {} x HEIGHT {} is {}, but POINTS is {}", *width, height.value_or(1),
                            area ? fmt::format("{}", *area) : "beyond 64 bits",
                            points ? fmt::format("{}", *points) : "not given"),
                at_line(where, lines[kWidth]));
  }
  header.points = *area;
  return {};
}

Expected<void> read_data_kind(const HeaderLines& lines, const std::string& where, PcdHeader& header) {
  constexpr std::array<std::string_view, 3> kNames = {"ascii", "binary", "binary_compressed"};
  std::string_view words = lines[kData].words;
  const auto found = std::find(kNames.begin(), kNames.end(), take_word(words));
  if (found == kNames.end()) {
    return fail(
        ErrorCode::kParse,
        fmt::format("DATA must be ascii, binary or binary_compressed, found \"{}\"", printable(lines[kData].words, 40)),
        at_line(where, lines[kData]));
  }
  header.data = static_cast<PcdData>(found - kNames.begin());
  return {};
}

Expected<void> check_version(const HeaderLines& lines, const std::string& where) {
  constexpr std::array<std::string_view, 6> kRead = {"0.7", ".7", "0.6", ".6", "0.5", ".5"};
  if (!lines[kVersion].is_given()) return {};
  std::string_view words = lines[kVersion].words;
  const std::string_view version = take_word(words);
  if (std::find(kRead.begin(), kRead.end(), version) != kRead.end()) return {};
  return fail(ErrorCode::kUnsupported, fmt::format("PCD version \"{}\"; 0.5 to 0.7 are read", printable(version, 40)),
              at_line(where, lines[kVersion]));
}

}  // namespace

Expected<PcdHeader> read_pcd_header(ByteCursor& bytes, const std::string& where) {
  if (bytes.remaining() == 0) return fail(ErrorCode::kTruncated, "the file is empty", where);
  const Expected<HeaderLines> lines = take_header_lines(bytes, where);
  if (!lines) return pass_up(lines.error());
  if (!(*lines)[kFields].is_given()) return fail(ErrorCode::kParse, "the PCD header has no FIELDS line", where);
  PcdHeader header;
  if (auto ok = check_version(*lines, where); !ok) return pass_up(ok.error());
  if (auto ok = read_fields(*lines, where, header); !ok) return pass_up(ok.error());
  if (auto ok = find_xyz(*lines, where, header); !ok) return pass_up(ok.error());
  if (auto ok = read_size(*lines, where, header); !ok) return pass_up(ok.error());
  if (auto ok = read_data_kind(*lines, where, header); !ok) return pass_up(ok.error());
  return header;
}

}  // namespace kilter
