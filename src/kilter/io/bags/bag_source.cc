// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>
#include <tuple>

#include "kilter/base/contract.h"
#include "kilter/io/bags/bag_log.h"
#include "kilter/io/bags/mcap.h"
#include "kilter/io/bags/rosbag1.h"
#include "kilter/io/bags/rosbag2_sqlite.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/random_access_file.h"
#include "kilter/io/sources/flat_folder.h"
#include "kilter/io/sources/source_kind.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kExtensions = {".mcap", ".db3", ".bag"};

using OpenReader = Expected<std::unique_ptr<BagReader>> (*)(const fs::path& path);

bool has_extension(std::string_view name, std::string_view extension) {
  const std::string lower = lower_case(name);
  return lower.ends_with(extension) || lower.ends_with(std::string(extension) + ".zstd");
}

bool holds_file_of(const fs::path& folder, std::string_view extension) {
  const auto names = is_folder(folder) ? list_folder(folder) : Expected<std::vector<std::string>>();
  return names && std::any_of(names->begin(), names->end(), [&](const std::string& name) {
           return has_extension(name, extension) && is_file(folder / name);
         });
}

// Looks one folder deep only: links may lead round and round.
bool is_other_source(const fs::path& folder) {
  if (has_clouds_and_poses(folder)) return true;
  if (std::any_of(kExtensions.begin(), kExtensions.end(),
                  [&](std::string_view extension) { return holds_file_of(folder, extension); })) {
    return true;
  }
  const auto kinds = source_kinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const SourceKind& kind) {
    return !kind.has_topics && kind.open != open_flat_folder && kind.matches(folder);
  });
}

bool is_bag_of(const fs::path& path, std::string_view extension) {
  if (is_file(path)) return has_extension(path.filename().native(), extension);
  if (!holds_file_of(path, extension)) return false;
  // A mission's folder may have the bags that it was made of beside its robots, or sessions of several kinds.
  const auto names = list_folder(path);
  return names && std::none_of(names->begin(), names->end(), [&](const std::string& name) {
           std::error_code error;
           const fs::path inside = path / name;
           return !name.starts_with('.') && is_folder(inside) && !fs::equivalent(inside, path, error) &&
                  is_other_source(inside);
         });
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

// The names below `relative_file_paths:`; none where there is no such file, or none in it.
std::vector<std::string> names_in_metadata(const fs::path& file) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20;
  std::vector<std::string> names;
  const auto bytes = read_file(file, kMostBytes);
  if (!bytes) return names;
  ByteCursor cursor(without_byte_order_mark(bytes->view()));
  bool is_list = false;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = *line;
    const std::string_view word = take_word(rest);
    if (is_list && word == "-") {
      std::string_view name = take_word(rest);
      if (name.size() > 2 && (name.front() == '"' || name.front() == '\'')) name = name.substr(1, name.size() - 2);
      names.emplace_back(name.substr(name.rfind('/') + 1));
    } else {
      is_list = word == "relative_file_paths:";
    }
  }
  return names;
}

// Of a folder whose names do not number the parts of one recording, those that metadata.yaml lists.
Expected<std::vector<Part>> parts_of_one(const SourceRequest& request, std::string_view extension,
                                         std::vector<Part> parts, std::vector<std::string>& notes) {
  const std::vector<std::string> listed = names_in_metadata(request.path / "metadata.yaml");
  std::vector<Part> wanted;
  std::vector<std::string> left_out;
  for (Part& part : parts) {
    if (std::find(listed.begin(), listed.end(), part.name) != listed.end()) {
      wanted.push_back(std::move(part));
    } else {
      left_out.push_back(part.name);
    }
  }
  if (wanted.empty()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected the parts of one recording (NAME_0{0}, NAME_1{0}, ...), found {1} and {2}",
                            extension, printable(left_out.front(), 80), printable(left_out.back(), 80)),
                shown(request.path), "name each bag: kilter check a=PATH b=PATH");
  }
  if (!left_out.empty()) {
    notes.push_back(fmt::format("robot {}: {} {} left out, since metadata.yaml does not list {}", request.name,
                                some_of(left_out), left_out.size() == 1 ? "is" : "are",
                                left_out.size() == 1 ? "it" : "them"));
  }
  return wanted;
}

// Which of them is meant is not for kilter to say: they may be one recording converted, or several.
Expected<void> check_one_format(const fs::path& folder, const std::vector<std::string>& names,
                                std::string_view extension, const std::string& found) {
  for (const std::string_view other : kExtensions) {
    if (other == extension) continue;
    const auto bag = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return !name.starts_with('.') && has_extension(name, other) && is_file(folder / name);
    });
    if (bag == names.end()) continue;
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected one recording, found {} and {}", printable(found, 80), printable(*bag, 80)),
                shown(folder), "name each bag: kilter check a=PATH b=PATH");
  }
  return {};
}

// A folder's parts of one recording, in order. Names come from the folder itself; metadata.yaml is asked only where
// they are not those of one recording.
Expected<std::vector<fs::path>> files_of(const SourceRequest& request, std::string_view extension,
                                         std::vector<std::string>& notes) {
  const fs::path& path = request.path;
  if (is_file(path)) return std::vector<fs::path>{path};
  const auto names = list_folder(path);
  if (!names) return pass_up(names.error());
  std::vector<Part> parts;
  for (const std::string& name : *names) {
    if (has_extension(name, extension) && is_file(path / name)) parts.push_back(part_of(name));
  }
  KILTER_EXPECTS(!parts.empty());
  if (auto ok = check_one_format(path, *names, extension, parts.front().name); !ok) return pass_up(ok.error());
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::tie(a.recording, a.number, a.name) < std::tie(b.recording, b.number, b.name);
  });
  if (parts.front().recording != parts.back().recording) {
    auto wanted = parts_of_one(request, extension, std::move(parts), notes);
    if (!wanted) return pass_up(wanted.error());
    parts = *std::move(wanted);
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
  const auto paths = files_of(request, extension, notes);
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
