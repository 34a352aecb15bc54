// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/robot_folder.h"

#include <fmt/format.h>

#include <optional>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/number_text.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/foreign_file.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// A folder's clouds in order, and what else lies there.
struct CloudList {
  std::vector<std::string> files;
  std::vector<std::string> ignored;
};

// What one folder holds of: a format of clouds, or OctoMap trees. Nothing for a file that is passed over.
std::optional<std::string> family_of(std::string_view name, bool finished_submaps) {
  if (finished_submaps && has_octree_name(name)) return "octree";
  const std::optional<CloudFormat> format = cloud_format_of(name);
  if (!format || (finished_submaps && *format == CloudFormat::kBin)) return std::nullopt;
  return lower_case(name.substr(name.rfind('.')));
}

Expected<CloudList> list_clouds(const fs::path& folder, bool finished_submaps) {
  auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  CloudList list;
  std::optional<std::string> first_family;
  for (std::string& name : *names) {
    if (name.starts_with('.')) continue;
    const std::optional<std::string> family = family_of(name, finished_submaps);
    if (!family) {
      list.ignored.push_back(std::move(name));
      continue;
    }
    // Passing it over would shift every later scan to another pose.
    if (auto ok = expect_file(folder / name); !ok) return pass_up(ok.error());
    if (first_family && *family != *first_family) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("one folder holds one format, found {} and {}", printable(list.files.front(), 80),
                              printable(name, 80)),
                  shown(folder), "move the files of one of them away");
    }
    first_family = family;
    list.files.push_back(std::move(name));
  }
  if (!list.files.empty()) return list;
  const std::string expected =
      finished_submaps ? "no .ot, .bt, .pcd, .ply or .las file" : "no .bin, .pcd, .ply or .las file";
  return fail(ErrorCode::kEmptyInput,
              list.ignored.empty() ? expected : fmt::format("{}, only {}", expected, some_of(list.ignored)),
              shown(folder), way_out_of_foreign(list.ignored));
}

// Names like 1, 2, 10 sort bytewise as 1, 10, 2, which is what counts here but seldom what was meant.
std::optional<std::size_t> find_misorder(const std::vector<std::string>& files) {
  for (std::size_t i = 1; i < files.size(); ++i) {
    const auto before = number_of_file(files[i - 1]);
    const auto here = number_of_file(files[i]);
    if (before && here && *here < *before) return i;
  }
  return std::nullopt;
}

void note_oddities(const CloudList& list, const std::string& robot, const std::string& folder,
                   std::vector<std::string>& notes) {
  if (!list.ignored.empty()) {
    notes.push_back(
        fmt::format("robot {}: {} of {}/ {} ignored: {}", robot,
                    list.ignored.size() == 1 ? "one entry" : std::to_string(list.ignored.size()) + " entries", folder,
                    list.ignored.size() == 1 ? "was" : "were", some_of(list.ignored)));
  }
  if (const auto i = find_misorder(list.files)) {
    notes.push_back(
        fmt::format("robot {}: names sort bytewise, so {} comes before {}; pad numbers with zeros if that "
                    "is not the order of the poses",
                    robot, printable(list.files[*i - 1], 80), printable(list.files[*i], 80)));
  }
}

// Clouds and poses pair in order, which a column of names must not contradict.
Expected<void> check_names(const std::vector<std::string>& clouds, const PoseList& poses, const fs::path& pose_file) {
  for (std::size_t i = 0; i < poses.files.size(); ++i) {
    const std::string& named = poses.files[i];
    if (named == clouds[i] || named == clouds[i].substr(0, clouds[i].rfind('.'))) continue;
    return fail(ErrorCode::kCountMismatch,
                fmt::format("pose {} (the first being 0) names {}, but cloud {} is {}", i, printable(named, 80), i,
                            printable(clouds[i], 80)),
                shown(pose_file),
                "order its lines as the clouds' names sort bytewise, or leave the column of names out");
  }
  return {};
}

}  // namespace

bool is_robot_folder(const fs::path& folder) { return is_folder(folder / "scans") || is_folder(folder / "submaps"); }

Expected<RobotLog> open_robot_folder(const SourceRequest& request, std::vector<std::string>& notes) {
  RobotLog log;
  log.name = request.name;
  log.finished_submaps = is_folder(request.path / "submaps");
  if (log.finished_submaps && is_folder(request.path / "scans")) {
    return fail(ErrorCode::kUnsupported, "found both scans/ and submaps/, expected one of them", shown(request.path),
                "move one of them into another robot's folder, with its poses.*");
  }
  const fs::path clouds = request.path / (log.finished_submaps ? "submaps" : "scans");
  const Expected<CloudList> list = list_clouds(clouds, log.finished_submaps);
  if (!list) return pass_up(list.error());
  const auto pose_file = find_pose_file(request.poses_folder.value_or(request.path));
  if (!pose_file) return pass_up(pose_file.error());
  auto poses = read_pose_file(*pose_file);
  if (!poses) return pass_up(poses.error());
  const std::size_t count = poses->T_world_cloud.size();
  if (count != list->files.size()) return refuse_counts(list->files, count, *pose_file, clouds);
  if (auto ok = check_names(list->files, *poses, *pose_file); !ok) return pass_up(ok.error());
  note_oddities(*list, log.name, clouds.filename().string(), notes);
  take_stamps(log, *poses);
  log.T_world_cloud = std::move(poses->T_world_cloud);
  std::vector<fs::path> paths;
  for (const std::string& file : list->files) paths.push_back(clouds / file);
  if (log.finished_submaps && has_octree_name(list->files.front())) {
    if (auto ok = read_from_octrees(log, std::move(paths)); !ok) return pass_up(ok.error());
  } else {
    read_from_files(log, std::move(paths));
  }
  return log;
}

}  // namespace kilter
