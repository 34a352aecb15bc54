// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "kilter/io/bags/bag_log.h"
#include "kilter/io/bags/mcap.h"
#include "kilter/io/bags/rosbag1.h"
#include "kilter/io/bags/rosbag2_sqlite.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/random_access_file.h"
#include "kilter/io/sources/robot_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

using OpenReader = Expected<std::unique_ptr<BagReader>> (*)(const fs::path& path);

bool has_extension(std::string_view name, std::string_view extension) {
  const std::string lower = lower_case(name);
  return lower.ends_with(extension) || lower.ends_with(std::string(extension) + ".zstd");
}

bool is_bag_of(const fs::path& path, std::string_view extension) {
  if (is_file(path)) return has_extension(path.filename().native(), extension);
  const auto names = is_folder(path) ? list_folder(path) : Expected<std::vector<std::string>>();
  if (!names) return false;
  const auto is_part = [&](const std::string& name) { return has_extension(name, extension) && is_file(path / name); };
  // A mission's folder may have the bags that it was made of beside its robots.
  return std::any_of(names->begin(), names->end(), is_part) &&
         std::none_of(names->begin(), names->end(),
                      [&](const std::string& name) { return is_robot_folder(path / name); });
}

// "run_12.mcap" is part 12 of "run".
struct Part {
  std::string recording;
  std::optional<std::uint64_t> number;
  std::string name;
};

Part part_of(const std::string& name) {
  const std::string stem = name.substr(0, name.find('.'));
  const std::size_t underscore = stem.rfind('_');
  const auto number =
      underscore == std::string::npos ? std::nullopt : parse_count(std::string_view(stem).substr(underscore + 1));
  return {number ? stem.substr(0, underscore) : stem, number, name};
}

// A folder's parts of one recording, in order. Names come from the folder itself: what metadata.yaml says is not
// needed.
Expected<std::vector<fs::path>> files_of(const fs::path& path, std::string_view extension) {
  if (is_file(path)) return std::vector<fs::path>{path};
  const auto names = list_folder(path);
  if (!names) return pass_up(names.error());
  std::vector<Part> parts;
  for (const std::string& name : *names) {
    if (has_extension(name, extension) && is_file(path / name)) parts.push_back(part_of(name));
  }
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::tie(a.recording, a.number, a.name) < std::tie(b.recording, b.number, b.name);
  });
  if (parts.size() > 1 && parts.front().recording != parts.back().recording && !is_file(path / "metadata.yaml")) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected the parts of one recording (NAME_0{0}, NAME_1{0}, ...), found {1} and {2}",
                            extension, printable(parts.front().name, 80), printable(parts.back().name, 80)),
                shown(path), "name each bag: kilter check a=PATH b=PATH");
  }
  std::vector<fs::path> files;
  files.reserve(parts.size());
  for (const Part& part : parts) files.push_back(path / part.name);
  return files;
}

// What bzip2 unpacks in half a second, or less.
constexpr std::uint64_t kGlanceBytes = std::uint64_t{4} << 20;

Expected<RobotLog> open_bag_within(UnpackingBudget budget, const SourceRequest& request, std::string_view extension,
                                   OpenReader open, std::vector<std::string>& notes) {
  const auto paths = files_of(request.path, extension);
  if (!paths) return pass_up(paths.error());
  BagFiles files;
  files.reserve(paths->size());
  for (const fs::path& path : *paths) {
    if (lower_case(path.native()).ends_with(".zstd")) {
      return fail(ErrorCode::kUnsupported, "this bag was packed as a whole file, which kilter does not read",
                  shown(path), "unpack it: `zstd -d FILE`");
    }
    auto file = open(path);
    if (!file) return pass_up(file.error());
    files.push_back(*std::move(file));
  }
  return make_bag_log(request.name, std::move(files), request.topics, shown(request.path), notes, budget);
}

Expected<RobotLog> open_bag(const SourceRequest& request, std::string_view extension, OpenReader open,
                            std::vector<std::string>& notes) {
  if (request.glance) {
    const std::size_t notes_before = notes.size();
    auto log = open_bag_within(UnpackingBudget(kGlanceBytes), request, extension, open, notes);
    if (log) return log;
    // What the beginning lacks may follow.
    notes.resize(notes_before);
  }
  return open_bag_within({}, request, extension, open, notes);
}

}  // namespace

bool is_rosbag1(const fs::path& path) {
  const std::string name = lower_case(path.filename().native());
  return is_file(path) && (name.ends_with(".bag") || name.ends_with(".bag.active"));
}

bool is_sqlite_bag(const fs::path& path) { return is_bag_of(path, ".db3"); }
bool is_mcap_bag(const fs::path& path) { return is_bag_of(path, ".mcap"); }

Expected<RobotLog> open_rosbag1_source(const SourceRequest& request, std::vector<std::string>& notes) {
  const OpenReader open = [](const fs::path& path) -> Expected<std::unique_ptr<BagReader>> {
    auto file = RandomAccessFile::open(path);
    if (!file) return pass_up(file.error());
    return open_rosbag1(*std::move(file));
  };
  return open_bag(request, ".bag", open, notes);
}

Expected<RobotLog> open_sqlite_source(const SourceRequest& request, std::vector<std::string>& notes) {
  return open_bag(request, ".db3", open_rosbag2_sqlite, notes);
}

Expected<RobotLog> open_mcap_source(const SourceRequest& request, std::vector<std::string>& notes) {
  const OpenReader open = [](const fs::path& path) -> Expected<std::unique_ptr<BagReader>> {
    auto file = RandomAccessFile::open(path);
    if (!file) return pass_up(file.error());
    return open_mcap(*std::move(file));
  };
  return open_bag(request, ".mcap", open, notes);
}

}  // namespace kilter
