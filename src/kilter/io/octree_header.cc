// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/octree_header.h"

#include <fmt/format.h>

#include <optional>

#include "kilter/io/number_text.h"

namespace kilter {
namespace {

// Comments are free text, but no page of them is this long.
constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr double kMinResolution_m = 1e-4;
constexpr double kMaxResolution_m = 1e3;

struct Lines {
  std::optional<std::string_view> id;
  std::optional<std::string_view> size;
  std::optional<std::string_view> res;
};

Expected<OctreeFormat> take_format(ByteCursor& bytes, const std::string& where) {
  if (bytes.remaining() == 0) return fail(ErrorCode::kTruncated, "the file is empty", where);
  if (bytes.rest().starts_with(std::string_view("\3\0\0\0", 4))) {
    return fail(ErrorCode::kUnsupported, "a binary tree without a header, as OctoMap wrote them before version 1.0",
                where, "`convert_octree IN.bt OUT.ot`, which comes with OctoMap");
  }
  const std::string_view line = bytes.take_line().value_or("");
  if (line.starts_with(kBinaryOctreeLine)) return OctreeFormat::kBinary;
  if (line.starts_with(kFullOctreeLine)) return OctreeFormat::kFull;
  return fail(ErrorCode::kParse,
              fmt::format("expected the first line \"{}\" or \"{}\", found \"{}\"", kFullOctreeLine, kBinaryOctreeLine,
                          printable(line, 60)),
              where + ":1");
}

Expected<Lines> take_lines(ByteCursor& bytes, const std::string& where) {
  Lines lines;
  while (bytes.position() <= kMaxHeaderBytes) {
    std::optional<std::string_view> line = bytes.take_line();
    if (!line) break;
    const std::string_view key = take_word(*line);
    if (key == "data") return lines;
    if (key == "id") lines.id = take_word(*line);
    if (key == "size") lines.size = take_word(*line);
    if (key == "res") lines.res = take_word(*line);
  }
  return fail(ErrorCode::kTruncated,
              fmt::format("expected a line \"data\" within the first {} bytes, found none", kMaxHeaderBytes), where);
}

// \return  how many bytes of colour a node of that class has.
Expected<std::size_t> colour_of_class(std::string_view id, const std::string& where) {
  // "1" is how OctoMap 1.0 called its OcTree; the stamps of an OcTreeStamped do not go into its files.
  if (id == "OcTree" || id == "1" || id == "OcTreeStamped") return std::size_t{0};
  if (id == "ColorOcTree") return std::size_t{3};
  return fail(ErrorCode::kUnsupported,
              fmt::format("a tree of class \"{}\", expected OcTree, ColorOcTree or OcTreeStamped", printable(id, 40)),
              where, "save it as an OcTree, or its occupied cells' centres as .pcd or .ply");
}

tl::unexpected<Error> refuse_line(std::string_view key, std::string_view expected,
                                  const std::optional<std::string_view>& found, const std::string& where) {
  return fail(ErrorCode::kParse,
              found ? fmt::format("expected {} after \"{}\", found \"{}\"", expected, key, printable(*found, 40))
                    : fmt::format("expected a line \"{} ...\" before \"data\", found none", key),
              where);
}

}  // namespace

Expected<OctreeHeader> take_octree_header(ByteCursor& bytes, const std::string& where) {
  OctreeHeader header;
  const Expected<OctreeFormat> format = take_format(bytes, where);
  if (!format) return pass_up(format.error());
  header.format = *format;
  const Expected<Lines> lines = take_lines(bytes, where);
  if (!lines) return pass_up(lines.error());
  if (!lines->id) return refuse_line("id", "the class of the tree", lines->id, where);
  const Expected<std::size_t> colour = colour_of_class(*lines->id, where);
  if (!colour) return pass_up(colour.error());
  header.colour_bytes = *colour;
  const auto nodes = lines->size ? parse_count(*lines->size) : std::nullopt;
  if (!nodes) return refuse_line("size", "the number of nodes", lines->size, where);
  header.nodes = *nodes;
  const auto resolution_m = lines->res ? parse_real(*lines->res) : std::nullopt;
  if (!resolution_m || !(*resolution_m >= kMinResolution_m && *resolution_m <= kMaxResolution_m)) {
    return refuse_line("res", "the edge of a cell, 0.0001 to 1000 m,", lines->res, where);
  }
  header.resolution_m = *resolution_m;
  return header;
}

}  // namespace kilter
