// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/robot_folder.h"

#include <fmt/format.h>

#include <optional>

#include "kilter/io/cloud_file.h"
#include "kilter/io/count_mismatch.h"
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
  const auto numbers = numbers_of_files(files);
  for (std::size_t i = 1; numbers && i < files.size(); ++i) {
    if ((*numbers)[i] < (*numbers)[i - 1]) return i;
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
  if (count != list->files.size()) return refuse_counts(list->files, *poses, *pose_file, clouds);
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
