// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/robot_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <system_error>

#include "kilter/base/contract.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_reader.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// A trajectory of a million poses has some 100 MB.
constexpr std::uint64_t kMaxPoseFileBytes = std::uint64_t{1} << 30;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

// Follows links; false for links to nothing.
bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// The first few names, for messages.
std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    text += (i == 0 ? "" : ", ") + printable(names[i], 80);
  }
  return names.size() > kShown ? text + ", ..." : text;
}

Expected<fs::path> find_pose_file(const fs::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  std::vector<std::string> found;
  for (const std::string& name : *names) {
    if (name.starts_with("poses.") && is_file(folder / name)) found.push_back(name);
  }
  if (found.size() == 1) return folder / found.front();
  if (found.empty()) {
    return fail(ErrorCode::kNotFound, "expected a file poses.*, found none", shown(folder),
                "one pose T_world_sensor per scan, e.g. poses.tum with lines `t x y z qx qy qz qw`");
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("expected one file poses.*, found {}: {}", found.size(), some_of(found)), shown(folder),
              "move the others away, or name the wanted ones by --poses");
}

// A folder's clouds in order, and what else lies there.
struct CloudList {
  std::vector<std::string> files;
  std::vector<std::string> ignored;
};

bool is_octree(std::string_view name) { return name.ends_with(".ot") || name.ends_with(".bt"); }

Expected<CloudList> list_clouds(const fs::path& folder, bool finished_submaps) {
  auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  CloudList list;
  std::optional<CloudFormat> first_format;
  for (std::string& name : *names) {
    if (name.starts_with('.')) continue;
    if (finished_submaps && is_octree(name)) {
      return fail(ErrorCode::kUnsupported, "OctoMap trees (.ot, .bt) are not read", shown(folder / name),
                  "save the occupied cells' centres as .pcd or .ply, in the submap's own frame");
    }
    const std::optional<CloudFormat> format = cloud_format_of(name);
    if (!format || (finished_submaps && *format == CloudFormat::kBin)) {
      list.ignored.push_back(std::move(name));
      continue;
    }
    if (!is_file(folder / name)) {
      // Passing it over would shift every later scan to another pose.
      return fail(ErrorCode::kUnsupported, "named like a cloud, but neither a file nor a link to one",
                  shown(folder / name));
    }
    if (first_format && *format != *first_format) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("one folder holds one format, found {} and {}", printable(list.files.front(), 80),
                              printable(name, 80)),
                  shown(folder));
    }
    first_format = format;
    list.files.push_back(std::move(name));
  }
  if (!list.files.empty()) return list;
  const std::string expected = finished_submaps ? "no .pcd or .ply file" : "no .bin, .pcd or .ply file";
  return fail(ErrorCode::kEmptyInput,
              list.ignored.empty() ? expected : fmt::format("{}, only {}", expected, some_of(list.ignored)),
              shown(folder));
}

// "000012" of "000012.pcd", as a number, if it is one.
std::optional<std::uint64_t> number_of(std::string_view file) { return parse_count(file.substr(0, file.rfind('.'))); }

// The first file whose number is not its neighbour's plus one: most likely a scan between them is gone.
std::optional<std::size_t> find_gap(const std::vector<std::string>& files) {
  for (std::size_t i = 1; i < files.size(); ++i) {
    const auto before = number_of(files[i - 1]);
    const auto here = number_of(files[i]);
    if (!before || !here || *here <= *before) return std::nullopt;
    if (*here - *before > 1) return i;
  }
  return std::nullopt;
}

tl::unexpected<Error> refuse_counts(const std::vector<std::string>& files, std::size_t poses, const fs::path& pose_file,
                                    const fs::path& clouds) {
  const std::string counts = fmt::format("{} poses in {}, but {} files in {}", poses, shown(pose_file.filename()),
                                         files.size(), shown(clouds.filename()));
  std::string missing;
  if (poses < files.size()) {
    missing = fmt::format("{} is the first without a pose", printable(files[poses], 80));
  } else if (const auto gap = find_gap(files)) {
    missing = fmt::format("the first missing one lies between {} and {}", printable(files[*gap - 1], 80),
                          printable(files[*gap], 80));
  } else {
    missing = fmt::format("pose {} (the first being 0) is the first without a file", files.size());
  }
  return fail(ErrorCode::kCountMismatch, counts + "; " + missing, shown(pose_file),
              "one pose per file, in the order of the files' names");
}

// Names like 1, 2, 10 sort bytewise as 1, 10, 2, which is what counts here but seldom what was meant.
std::optional<std::size_t> find_misorder(const std::vector<std::string>& files) {
  for (std::size_t i = 1; i < files.size(); ++i) {
    const auto before = number_of(files[i - 1]);
    const auto here = number_of(files[i]);
    if (before && here && *here < *before) return i;
  }
  return std::nullopt;
}

void note_oddities(const CloudList& list, const std::string& robot, const std::string& folder,
                   std::vector<std::string>& notes) {
  if (!list.ignored.empty()) {
    notes.push_back(fmt::format("robot {}: {} entries of {}/ were ignored: {}", robot, list.ignored.size(), folder,
                                some_of(list.ignored)));
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

Expected<RobotLog> open_robot(const RobotFolder& robot, std::vector<std::string>& notes) {
  const bool finished_submaps = is_folder(robot.folder / "submaps");
  if (finished_submaps && is_folder(robot.folder / "scans")) {
    return fail(ErrorCode::kUnsupported, "found both scans/ and submaps/, expected one of them", shown(robot.folder));
  }
  const fs::path clouds = robot.folder / (finished_submaps ? "submaps" : "scans");
  Expected<CloudList> list = list_clouds(clouds, finished_submaps);
  if (!list) return pass_up(list.error());
  const auto pose_file = find_pose_file(robot.poses_folder);
  if (!pose_file) return pass_up(pose_file.error());
  const auto bytes = read_file(*pose_file, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  auto poses = read_poses(bytes->view(), shown(*pose_file));
  if (!poses) return pass_up(poses.error());
  if (poses->size() != list->files.size()) return refuse_counts(list->files, poses->size(), *pose_file, clouds);
  note_oddities(*list, robot.name, clouds.filename().string(), notes);

  RobotLog log;
  log.name = robot.name;
  log.T_world_cloud = *std::move(poses);
  log.finished_submaps = finished_submaps;
  const auto files = std::make_shared<const std::vector<std::string>>(std::move(list->files));
  log.read_cloud = [clouds, files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return read_cloud_file(clouds / (*files)[i]);
  };
  log.cloud_name = [clouds, files](std::size_t i) {
    KILTER_EXPECTS(i < files->size());
    return shown(clouds / (*files)[i]);
  };
  return log;
}

}  // namespace kilter
