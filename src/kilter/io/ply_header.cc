// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/ply_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "kilter/io/number_text.h"

namespace kilter {
namespace {

// More than any scanner writes; keeps what a hostile header can cost small.
constexpr std::size_t kMaxElements = 256;
constexpr std::size_t kMaxProperties = 1024;

struct TypeName {
  std::string_view text;
  ScalarType type;
};

constexpr TypeName kTypeNames[] = {
    {"char", ScalarType::kInt8},       {"int8", ScalarType::kInt8},      {"uchar", ScalarType::kUint8},
    {"uint8", ScalarType::kUint8},     {"short", ScalarType::kInt16},    {"int16", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16},   {"uint16", ScalarType::kUint16},  {"int", ScalarType::kInt32},
    {"int32", ScalarType::kInt32},     {"uint", ScalarType::kUint32},    {"uint32", ScalarType::kUint32},
    {"int64", ScalarType::kInt64},     {"uint64", ScalarType::kUint64},  {"float", ScalarType::kFloat32},
    {"float32", ScalarType::kFloat32}, {"double", ScalarType::kFloat64}, {"float64", ScalarType::kFloat64},
};

std::optional<ScalarType> scalar_type(std::string_view text) {
  for (const TypeName& name : kTypeNames) {
    if (name.text == text) return name.type;
  }
  return std::nullopt;
}

bool is_integer(ScalarType type) { return type != ScalarType::kFloat32 && type != ScalarType::kFloat64; }

// Lines of a header are read into `header_`; errors say what was expected, the place is added by the caller.
class HeaderLines {
 public:
  // `words` is what follows `keyword`.
  Expected<void> read(std::string_view keyword, std::string_view words) {
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return {};
    if (keyword == "format") return read_format(words);
    if (keyword == "element") return read_element(words);
    if (keyword == "property") return read_property(words);
    return fail(ErrorCode::kParse, fmt::format("expected a PLY header line, found \"{}\"", printable(keyword, 40)), {},
                "a PLY header has format, element, property, comment and end_header lines");
  }

  // What end_header closes.
  Expected<PlyHeader> finish() && {
    if (!has_format_) return fail(ErrorCode::kParse, "the PLY header has no format line");
    const auto is_vertex = [](const PlyElement& element) { return element.name == "vertex"; };
    const auto vertex = std::find_if(header_.elements.begin(), header_.elements.end(), is_vertex);
    if (vertex == header_.elements.end()) return fail(ErrorCode::kParse, "the PLY header has no element \"vertex\"");
    header_.vertex = static_cast<std::size_t>(vertex - header_.elements.begin());
    if (auto found = find_xyz(*vertex); !found) return pass_up(found.error());
    return std::move(header_);
  }

 private:
  Expected<void> read_format(std::string_view words) {
    const std::string_view format = take_word(words);
    const std::string_view version = take_word(words);
    if (has_format_) return fail(ErrorCode::kParse, "a second format line");
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
      return fail(ErrorCode::kParse,
                  fmt::format("expected format ascii, binary_little_endian or binary_big_endian, found \"{}\"",
                              printable(format, 40)));
    }
    if (version != "1.0") {
      return fail(ErrorCode::kUnsupported, fmt::format("PLY version \"{}\"; 1.0 is read", printable(version, 40)));
    }
    has_format_ = true;
    header_.is_ascii = format == "ascii";
    header_.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
    return {};
  }

  Expected<void> read_element(std::string_view words) {
    const std::string_view name = take_word(words);
    const std::string_view count = take_word(words);
    const std::optional<std::uint64_t> rows = parse_count(count);
    if (!rows) {
      return fail(ErrorCode::kParse,
                  fmt::format("element \"{}\": its count must be a whole number that is not negative, found \"{}\"",
                              printable(name, 40), printable(count, 40)));
    }
    const auto same = [&](const PlyElement& element) { return element.name == name; };
    if (std::any_of(header_.elements.begin(), header_.elements.end(), same)) {
      return fail(ErrorCode::kParse, fmt::format("element \"{}\" is declared twice", printable(name, 40)));
    }
    if (header_.elements.size() >= kMaxElements) {
      return fail(ErrorCode::kUnsupported, fmt::format("more than {} elements", kMaxElements));
    }
    header_.elements.push_back({.name = name, .rows = *rows, .properties = {}});
    return {};
  }

  Expected<void> read_property(std::string_view words) {
    if (header_.elements.empty()) return fail(ErrorCode::kParse, "a property before the first element");
    PlyElement& element = header_.elements.back();
    if (element.properties.size() >= kMaxProperties) {
      return fail(ErrorCode::kUnsupported, fmt::format("more than {} properties in an element", kMaxProperties));
    }
    PlyProperty property;
    std::string_view type_name = take_word(words);
    if (type_name == "list") {
      const std::string_view length_name = take_word(words);
      property.length_type = scalar_type(length_name);
      if (!property.length_type || !is_integer(*property.length_type)) {
        return fail(ErrorCode::kParse, fmt::format("expected an integer type for a list's length, found \"{}\"",
                                                   printable(length_name, 40)));
      }
      type_name = take_word(words);
    }
    const std::optional<ScalarType> type = scalar_type(type_name);
    if (!type) {
      return fail(ErrorCode::kParse,
                  fmt::format("expected a PLY type such as float or uchar, found \"{}\"", printable(type_name, 40)));
    }
    property.type = *type;
    property.name = take_word(words);
    if (property.name.empty()) return fail(ErrorCode::kParse, "expected the property's name at the end of the line");
    element.properties.push_back(property);
    return {};
  }

  Expected<void> find_xyz(const PlyElement& vertex) {
    constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto is_axis = [&](const PlyProperty& p) { return p.name == kNames[axis] && !p.length_type; };
      const auto found = std::find_if(vertex.properties.begin(), vertex.properties.end(), is_axis);
      const auto number = std::count_if(vertex.properties.begin(), vertex.properties.end(), is_axis);
      if (number != 1) {
        return fail(ErrorCode::kParse,
                    fmt::format("element \"vertex\" must have exactly one number \"{}\" among its properties, found {}",
                                kNames[axis], number));
      }
      header_.xyz[axis] = static_cast<std::size_t>(found - vertex.properties.begin());
    }
    return {};
  }

  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& p) { return p.length_type.has_value(); });
}

std::uint64_t PlyElement::row_bytes() const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.type);
  return bytes;
}

Expected<PlyHeader> read_ply_header(ByteCursor& bytes, const std::string& where) {
  if (bytes.remaining() == 0) return fail(ErrorCode::kTruncated, "the file is empty", where);
  const auto in_line = [&](Error error) {
    error.where = fmt::format("{}:{}", where, bytes.line());
    return pass_up(std::move(error));
  };
  HeaderLines lines;
  while (const std::optional<std::string_view> line = bytes.take_line()) {
    std::string_view words = *line;
    const std::string_view keyword = take_word(words);
    if (bytes.line() == 1) {
      if (keyword == "ply") continue;
      return in_line({ErrorCode::kParse,
                      fmt::format("a PLY file begins with \"ply\", found \"{}\"", printable(keyword, 40)),
                      {},
                      {}});
    }
    if (keyword == "end_header") {
      Expected<PlyHeader> header = std::move(lines).finish();
      return header ? std::move(header) : in_line(std::move(header.error()));
    }
    if (auto read = lines.read(keyword, words); !read) return in_line(std::move(read.error()));
  }
  return fail(ErrorCode::kTruncated, "the file ends before the end_header line of its PLY header", where);
}

}  // namespace kilter
