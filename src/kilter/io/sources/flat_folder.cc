// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/flat_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/pose_list.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/numbered_folders.h"
#include "kilter/io/sources/pose_pairing.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 9> kPoseExtensions = {".txt",   ".tum",  ".csv",        ".tsv",     ".g2o",
                                                             ".kitti", ".traj", ".trajectory", ".freiburg"};

bool is_named_like_poses(std::string_view name) {
  const std::string lower = lower_case(name);
  return lower.find("pose") != std::string::npos || lower.find("traj") != std::string::npos;
}

bool may_hold_poses(const std::string& name) {
  if (name.starts_with('.') || cloud_format_of(name)) return false;
  const std::string lower = lower_case(name);
  return lower.starts_with("poses.") ||
         std::any_of(kPoseExtensions.begin(), kPoseExtensions.end(),
                     [&](std::string_view extension) { return lower.ends_with(extension); });
}

// Files that begin like lists of poses; if there are none, those that are only named so, whose reader then says what is
// wrong with them.
std::vector<std::string> find_pose_lists(const fs::path& folder, const std::vector<std::string>& names) {
  constexpr std::size_t kMostLookedAt = 32;  // a text file for each cloud is no list of poses
  std::vector<std::string> candidates;
  std::copy_if(names.begin(), names.end(), std::back_inserter(candidates),
               [&](const std::string& name) { return may_hold_poses(name) && is_file(folder / name); });
  const auto unnamed = std::stable_partition(candidates.begin(), candidates.end(), is_named_like_poses);
  const std::vector<std::string> named(candidates.begin(), unnamed);
  candidates.resize(std::min(candidates.size(), kMostLookedAt));
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::string> found;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(found),
               [&](const std::string& name) { return guess_pose_layout(first_bytes(folder / name)).has_value(); });
  return found.empty() ? named : found;
}

// What is no source though clouds and tables lie in it: kilter's own output, and one submap of a GLIM dump.
bool is_part_of_something(const fs::path& folder) {
  return is_file(folder / "result.json") || is_file(folder / "points_compact.bin");
}

bool holds_other_sources(const fs::path& folder, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    if (name.starts_with('.') || !is_folder(folder / name)) return false;
    const auto kinds = source_kinds();
    return std::any_of(kinds.begin(), kinds.end(), [&](const SourceKind& kind) {
      return kind.open != open_flat_folder && kind.matches(folder / name);
    });
  });
}

Expected<fs::path> find_pose_list(const fs::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  const std::vector<std::string> found = find_pose_lists(folder, *names);
  if (found.size() == 1) return folder / found.front();
  if (found.empty()) {
    return fail(ErrorCode::kNotFound, "expected a list of poses beside the clouds, found none", shown(folder),
                "for example poses.txt with lines `t x y z qx qy qz qw`");
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("expected one list of poses beside the clouds, found {}: {}", found.size(), some_of(found)),
              shown(folder), "move the others away");
}

}  // namespace

bool has_clouds_and_poses(const fs::path& folder) {
  if (!is_folder(folder) || is_part_of_something(folder)) return false;
  const auto names = list_folder(folder);
  if (!names) return false;
  const bool has_cloud = std::any_of(names->begin(), names->end(), [&](const std::string& name) {
    return !name.starts_with('.') && cloud_format_of(name) && is_file(folder / name);
  });
  return has_cloud && !find_pose_lists(folder, *names).empty();
}

bool is_flat_folder(const fs::path& folder) {
  if (!has_clouds_and_poses(folder)) return false;
  const auto names = list_folder(folder);
  return names && !holds_other_sources(folder, *names);
}

Expected<RobotLog> open_flat_folder(const SourceRequest& request, std::vector<std::string>& notes) {
  auto names = list_clouds_of(request.path);
  if (!names) return pass_up(names.error());
  const Expected<fs::path> file = find_pose_list(request.path);
  if (!file) return pass_up(file.error());
  const auto bytes = read_file(*file, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  const Expected<PoseList> poses = read_pose_list(bytes->view(), shown(*file));
  if (!poses) return pass_up(poses.error());
  if (poses->layout == PoseLayout::kKitti && is_file(request.path / "calib.txt")) {
    notes.push_back(
        fmt::format("robot {}: {} is taken for the lidar's poses; if they are the camera's, as KITTI has them, move "
                    "the clouds into "
                    "a folder velodyne/ and calib.txt will be used",
                    request.name, shown(file->filename())));
  }
  RobotLog log;
  log.name = request.name;
  sort_by_number(*names);
  if (auto ok = pair_clouds(log, request.path, *names, *poses, *file, notes); !ok) return pass_up(ok.error());
  return log;
}

}  // namespace kilter
