// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/hdl_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/pose_numbers.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/numbered_folders.h"
#include "kilter/io/stamp_text.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kData = "data";
constexpr std::string_view kCloud = "cloud.pcd";

std::optional<std::int64_t> parse_ros_stamp(std::string_view line) {
  constexpr std::uint64_t kBillion = 1'000'000'000;
  const std::optional<std::uint64_t> seconds = parse_count(take_word(line));
  const std::optional<std::uint64_t> nanoseconds = parse_count(take_word(line));
  if (!seconds || !nanoseconds || *seconds > UINT32_MAX || *nanoseconds >= kBillion) return std::nullopt;
  return static_cast<std::int64_t>(*seconds * kBillion + *nanoseconds);
}

Expected<HdlKeyFrame> read_key_frame(const fs::path& folder) {
  const auto bytes = read_file(folder / kData, kMaxDataTextBytes);
  if (!bytes) return pass_up(bytes.error());
  return parse_hdl_key_frame(bytes->view(), shown(folder / kData));
}

struct KeyFrames {
  std::vector<HdlKeyFrame> frames;
  std::vector<fs::path> folders;
};

Expected<KeyFrames> read_key_frames(const fs::path& dump) {
  const auto names = list_numbered_folders(dump, kData);
  if (!names) return pass_up(names.error());
  KeyFrames all;
  for (const std::string& name : *names) {
    const Expected<HdlKeyFrame> frame = read_key_frame(dump / name);
    if (!frame) return pass_up(frame.error());
    if (!is_file(dump / name / kCloud)) {
      return fail(ErrorCode::kNotFound, fmt::format("expected {}, found none", kCloud), shown(dump / name),
                  "a key frame without its scan cannot be checked; dump again, or remove its folder");
    }
    all.frames.push_back(*frame);
    all.folders.push_back(dump / name);
  }
  if (all.frames.empty()) return fail(ErrorCode::kEmptyInput, "no key frame in it", shown(dump));
  return all;
}

bool lacks_estimate(const HdlKeyFrame& frame) { return !frame.estimate.has_value(); }

// hdl_graph_slam itself takes a key frame's estimate from the graph unless the key frame has one.
Expected<void> fill_from_graph(std::vector<HdlKeyFrame>& frames, const fs::path& graph) {
  if (!is_file(graph)) return {};
  const auto bytes = read_file(graph, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  const auto vertices = read_g2o_vertices(bytes->view(), shown(graph));
  if (!vertices) return pass_up(vertices.error());
  for (HdlKeyFrame& frame : frames) {
    if (frame.estimate || !frame.id) continue;
    const auto found = std::lower_bound(vertices->begin(), vertices->end(), *frame.id,
                                        [](const NumberedPose& vertex, std::uint64_t id) { return vertex.id < id; });
    if (found != vertices->end() && found->id == *frame.id) frame.estimate = found->T_world_cloud;
  }
  return {};
}

// A scan whose key frame's file is gone has no pose.
Expected<void> note_lost(const RobotLog& log, const fs::path& dump, std::vector<std::string>& notes) {
  const auto names = list_numbered_folders(dump, kCloud);
  if (!names) return pass_up(names.error());
  std::vector<std::string> lost;
  std::copy_if(names->begin(), names->end(), std::back_inserter(lost),
               [&](const std::string& name) { return !is_file(dump / name / kData); });
  if (lost.empty()) return {};
  notes.push_back(fmt::format("robot {}: {} {} {} but no file `{}`, so no pose, and {} left out", log.name,
                              some_of(lost), lost.size() == 1 ? "has a" : "have", kCloud, kData,
                              lost.size() == 1 ? "is" : "are"));
  return {};
}

// All from one frame: the map's and the odometry's must not be mixed.
Expected<void> choose_poses(RobotLog& log, const KeyFrames& all, std::vector<std::string>& notes) {
  const auto lacking = std::find_if(all.frames.begin(), all.frames.end(), lacks_estimate);
  if (lacking == all.frames.end()) {
    for (const HdlKeyFrame& frame : all.frames) log.T_world_cloud.push_back(*frame.estimate);
    return {};
  }
  const fs::path file = all.folders[static_cast<std::size_t>(lacking - all.frames.begin())] / kData;
  for (std::size_t i = 0; i < all.frames.size(); ++i) {
    if (!all.frames[i].odom) {
      return fail(ErrorCode::kParse,
                  fmt::format("no `estimate`, and no `odom` in {} to stand for it", shown(all.folders[i] / kData)),
                  shown(file), "dump again after at least one optimisation, or give poses by --poses");
    }
    log.T_world_cloud.push_back(*all.frames[i].odom);
  }
  notes.push_back(fmt::format(
      "robot {}: {} has no `estimate` and graph.g2o no vertex for it, so the odometry's poses serve for all {} key "
      "frames: what is judged is the odometry, not the optimised map",
      log.name, shown(file.parent_path().filename() / kData), all.frames.size()));
  return {};
}

}  // namespace

Expected<HdlKeyFrame> parse_hdl_key_frame(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  HdlKeyFrame frame;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = *line;
    const std::string_view word = take_word(rest);
    std::optional<Pose3>* matrix = word == "estimate" ? &frame.estimate : word == "odom" ? &frame.odom : nullptr;
    if (matrix != nullptr && !*matrix) {
      const Expected<Pose3> pose = take_matrix(cursor, word, where);
      if (!pose) return pass_up(pose.error());
      *matrix = *pose;
    } else if (word == "stamp" && !frame.stamp_ns) {
      frame.stamp_ns = parse_ros_stamp(rest);
    } else if (word == "id" && !frame.id) {
      frame.id = parse_count(take_word(rest));
    }
  }
  return frame;
}

bool is_hdl_dump(const fs::path& folder) {
  if (!is_folder(folder)) return false;
  const auto names = list_numbered_folders(folder, kData);
  return names && std::any_of(names->begin(), names->end(),
                              [&](const std::string& name) { return is_file(folder / name / kCloud); });
}

Expected<RobotLog> open_hdl_dump(const SourceRequest& request, std::vector<std::string>& notes) {
  Expected<KeyFrames> all = read_key_frames(request.path);
  if (!all) return pass_up(all.error());
  if (std::any_of(all->frames.begin(), all->frames.end(), lacks_estimate)) {
    if (auto ok = fill_from_graph(all->frames, request.path / "graph.g2o"); !ok) return pass_up(ok.error());
  }
  RobotLog log;
  log.name = request.name;
  if (auto ok = choose_poses(log, *all, notes); !ok) return pass_up(ok.error());
  for (const HdlKeyFrame& frame : all->frames) {
    if (frame.stamp_ns) log.stamps_ns.push_back(*frame.stamp_ns);
  }
  if (log.stamps_ns.size() != all->frames.size()) log.stamps_ns.clear();
  if (!log.stamps_ns.empty()) log.stamp_unit = symbol_of(StampUnit::kNanoseconds);  // beside whole seconds
  log.clouds_found = log.poses_found = all->frames.size();
  if (auto ok = note_lost(log, request.path, notes); !ok) return pass_up(ok.error());
  note_coarse_poses(log, "the files `data`", notes);
  std::vector<fs::path> clouds;
  for (const fs::path& folder : all->folders) clouds.push_back(folder / kCloud);
  read_from_files(log, std::move(clouds));
  return log;
}

}  // namespace kilter
