// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/glim_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "kilter/base/contract.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_numbers.h"
#include "kilter/io/scalar.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/numbered_folders.h"
#include "kilter/io/stamp_text.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCompactPoints = "points_compact.bin";
constexpr std::string_view kDoublePoints = "points.bin";

// The value behind `key` in a line `key: value`.
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  const std::string_view word = take_word(line);
  if (word.size() != key.size() + 1 || !word.starts_with(key) || !word.ends_with(':')) return std::nullopt;
  return take_word(line);
}

// A number that graph.txt tells, if it does.
std::optional<std::uint64_t> number_in_graph(std::string_view bytes, std::string_view key) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    if (const auto value = value_of(*line, key)) return parse_count(*value);
  }
  return std::nullopt;
}

// Three floats, or four doubles of which the last is 1.
std::size_t record_bytes(bool compact) { return compact ? 12 : 32; }

struct PointsFile {
  fs::path path;
  bool compact = true;
};

Expected<PointsFile> find_points(const fs::path& submap) {
  if (is_file(submap / kCompactPoints)) return PointsFile{submap / kCompactPoints, true};
  if (is_file(submap / kDoublePoints)) return PointsFile{submap / kDoublePoints, false};
  return fail(ErrorCode::kNotFound, fmt::format("expected {} (or {}), found neither", kCompactPoints, kDoublePoints),
              shown(submap), "a submap without points cannot be checked; dump the map again, or remove its folder");
}

void read_from_points_files(RobotLog& log, std::vector<PointsFile> points) {
  const auto files = std::make_shared<const std::vector<PointsFile>>(std::move(points));
  log.read_cloud = [files](std::size_t i) -> Expected<PointCloud> {
    KILTER_EXPECTS(i < files->size());
    const PointsFile& file = (*files)[i];
    const auto bytes = read_file(file.path);
    if (!bytes) return pass_up(bytes.error());
    return read_glim_points(bytes->view(), file.compact, shown(file.path));
  };
  log.peek_cloud = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    std::optional<CloudPeek> peek = peek_cloud_file((*files)[i].path);
    if (peek) {
      const std::size_t record = record_bytes((*files)[i].compact);
      peek->points = peek->bytes / record;
      peek->is_cut_short = peek->bytes == 0 || peek->bytes % record != 0;
    }
    return peek;
  };
  log.cloud_name = [files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return shown((*files)[i].path);
  };
}

Expected<GlimSubmap> read_submap(const fs::path& folder) {
  const auto bytes = read_file(folder / "data.txt", kMaxDataTextBytes);
  if (!bytes) return pass_up(bytes.error());
  return parse_glim_submap(bytes->view(), shown(folder / "data.txt"));
}

void note_missing(const RobotLog& log, const fs::path& folder, std::vector<std::string>& notes) {
  const auto expected = number_in_graph(first_bytes(folder / "graph.txt"), "num_submaps");
  if (!expected || *expected == log.T_world_cloud.size()) return;
  notes.push_back(fmt::format("robot {}: graph.txt names {} submaps, {} are there; the dump may be incomplete",
                              log.name, *expected, log.T_world_cloud.size()));
}

}  // namespace

Expected<GlimSubmap> parse_glim_submap(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::optional<Pose3> T_world_origin;
  std::optional<StampText> stamp;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    if (!T_world_origin && value_of(*line, "T_world_origin")) {
      const Expected<Pose3> pose = take_matrix(cursor, "T_world_origin", where);
      if (!pose) return pass_up(pose.error());
      T_world_origin = *pose;
    } else if (const auto value = value_of(*line, "stamp"); value && !stamp) {
      stamp = parse_stamp_text(*value);
    }
    if (T_world_origin && stamp) break;
  }
  if (!T_world_origin) {
    return fail(ErrorCode::kParse, "expected a line `T_world_origin:` above a 4x4 matrix, found none", where,
                "this is what GLIM writes for each submap; dump the map again");
  }
  GlimSubmap submap{*T_world_origin, std::nullopt};
  if (stamp) {
    const auto stamps_ns = to_nanoseconds(std::span(&*stamp, 1), StampUnit::kSeconds);
    if (stamps_ns) submap.stamp_ns = stamps_ns->front();
  }
  return submap;
}

Expected<PointCloud> read_glim_points(std::string_view bytes, bool compact, const std::string& where) {
  const ScalarType type = compact ? ScalarType::kFloat32 : ScalarType::kFloat64;
  const std::size_t number_bytes = compact ? 4 : 8;
  const std::size_t point_bytes = record_bytes(compact);
  if (bytes.empty()) return fail(ErrorCode::kTruncated, "the file is empty", where);
  if (bytes.size() % point_bytes != 0) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes are {} points of {} bytes and {} bytes more", bytes.size(),
                            bytes.size() / point_bytes, point_bytes, bytes.size() % point_bytes),
                where, "the dump was cut short, or was written by another version of GLIM");
  }
  PointCloud cloud;
  const auto column = [&](std::size_t i) {
    return CoordinateColumn{bytes.data() + i * number_bytes, point_bytes, type};
  };
  add_points(cloud, bytes.size() / point_bytes, {column(0), column(1), column(2)}, std::endian::little);
  return cloud;
}

bool is_glim_dump(const fs::path& folder) {
  const std::string graph = first_bytes(folder / "graph.txt");
  if (!number_in_graph(graph, "num_submaps")) return false;
  const auto submaps = list_numbered_folders(folder, "data.txt");
  return submaps && !submaps->empty();
}

Expected<RobotLog> open_glim_dump(const SourceRequest& request, std::vector<std::string>& notes) {
  RobotLog log;
  log.name = request.name;
  log.finished_submaps = true;
  const auto submaps = list_numbered_folders(request.path, "data.txt");
  if (!submaps) return pass_up(submaps.error());
  if (submaps->empty()) return fail(ErrorCode::kEmptyInput, "no submap in it", shown(request.path));
  std::vector<PointsFile> points;
  for (const std::string& name : *submaps) {
    const Expected<GlimSubmap> submap = read_submap(request.path / name);
    if (!submap) return pass_up(submap.error());
    const Expected<PointsFile> file = find_points(request.path / name);
    if (!file) return pass_up(file.error());
    log.T_world_cloud.push_back(submap->T_world_origin);
    if (submap->stamp_ns) log.stamps_ns.push_back(*submap->stamp_ns);
    points.push_back(*file);
  }
  if (log.stamps_ns.size() != log.T_world_cloud.size()) log.stamps_ns.clear();
  if (!log.stamps_ns.empty()) log.stamp_unit = symbol_of(StampUnit::kSeconds);
  log.clouds_found = log.poses_found = points.size();
  note_missing(log, request.path, notes);
  note_coarse_poses(log, "data.txt", notes);
  read_from_points_files(log, std::move(points));
  return log;
}

}  // namespace kilter
