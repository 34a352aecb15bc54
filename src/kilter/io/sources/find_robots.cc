// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/find_robots.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/foreign_file.h"
#include "kilter/io/sources/missed_robot.h"
#include "kilter/io/sources/robot_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// "run.bag#/points#/odom": a path, and topics of the bag there.
struct PathAndTopics {
  fs::path path;
  std::vector<std::string> topics;
};

PathAndTopics split_topics(const std::string& text) {
  PathAndTopics parts{text, {}};
  std::error_code error;
  // A file may be called so.
  if (text.find("#/") == std::string::npos || fs::exists(text, error)) return parts;
  parts.path = text.substr(0, text.find("#/"));
  for (std::size_t at = text.find("#/"); at != std::string::npos;) {
    const std::size_t next = text.find("#/", at + 1);
    parts.topics.push_back(text.substr(at + 1, next == std::string::npos ? next : next - at - 1));
    at = next;
  }
  return parts;
}

// Names become JSON keys like "a,b", folders of --poses and cells of CSV files. \return what is wrong, or nothing.
std::optional<std::string> find_fault(const std::string& name) {
  if (name.empty()) return "it is empty";
  if (name == "." || name == "..") return "it stands for a folder";
  if (name.find('/') != std::string::npos) return "it holds a '/'";
  if (name.find(',') != std::string::npos) return "it holds a comma";
  if (printable(name, name.size()) != name) return "it holds control characters or is not UTF-8";
  return std::nullopt;
}

// The last part of a path that is a name: "b" of "a/b/", and of "." the folder that it is.
std::string name_of_folder(const fs::path& folder) {
  const fs::path last = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
  if (!last.empty() && last != "." && last != "..") return last.string();
  std::error_code error;
  return fs::canonical(folder, error).filename().string();
}

// A file is called as its robot without its extension.
std::string name_of_path(const fs::path& path) { return is_file(path) ? path.stem().string() : name_of_folder(path); }

Expected<FoundRobot> robot_from_path(const fs::path& path, const SourceKind& kind) {
  const std::string name = name_of_path(path);
  if (const auto fault = find_fault(name)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("this {}'s name cannot be a robot's: {}", is_file(path) ? "file" : "folder", *fault),
                shown(path), "give the robot another name: NAME=PATH");
  }
  return FoundRobot{name, path, &kind, {}, {}, 0, {}};
}

// An output folder of check, or the archive or the JSON in it.
bool is_result(const fs::path& path) {
  const fs::path folder = is_folder(path) ? path : path.parent_path();
  const bool named = folder == path || path.extension() == ".kilter" || path.filename() == "result.json";
  return named && is_file(folder / "result.json") && is_file(folder / "result.kilter");
}

tl::unexpected<Error> refuse_result(const fs::path& path) {
  return fail(ErrorCode::kUnsupported, "this is a result of kilter check, no mission", shown(path),
              "kilter report draws it again; name the mission that it was made from instead");
}

tl::unexpected<Error> refuse_file(const fs::path& path) {
  if (is_result(path)) return refuse_result(path);
  // Most often a scan of KITTI's; octrees and other programs' dumps are called so, too.
  if (cloud_format_of(path.filename().native()) == CloudFormat::kBin) {
    return fail(ErrorCode::kUnsupported, "a .bin file alone does not tell what it holds, and is no source", shown(path),
                "name the folder above scans/, or save it as .pcd or .ply; kilter register takes two .bin scans");
  }
  return fail(ErrorCode::kUnsupported, "expected a folder or a file of a kind that kilter reads, found another file",
              shown(path), known_kinds());
}

// A robot's folder inside of a mission's, and links beside it that lead there, too.
struct Inside {
  fs::path path;
  std::vector<std::string> links;
};

// How many links lead on from one to the next until a folder is reached, 0 for a folder.
int links_to_folder(fs::path path) {
  constexpr int kMostLinks = 40;  // more the system does not follow either
  std::error_code error;
  int links = 0;
  for (; links < kMostLinks && fs::is_symlink(path, error); ++links) {
    path = path.parent_path() / fs::read_symlink(path, error);
    // "d/" and "d/." would be looked at behind the link d.
    while (path.has_relative_path() && (!path.has_filename() || path.filename() == ".")) path = path.parent_path();
  }
  return links;
}

// Programs leave a link `latest` beside the folder that it leads to; both would be one robot twice. Of names that lead
// to one folder the robot's is the folder itself, else the link that leads there with the fewest others between.
std::vector<Inside> each_once(const std::vector<fs::path>& entries) {
  std::vector<std::pair<int, fs::path>> ranked;
  ranked.reserve(entries.size());
  for (const fs::path& entry : entries) ranked.emplace_back(links_to_folder(entry), entry);
  std::sort(ranked.begin(), ranked.end());
  std::vector<Inside> robots;
  std::map<std::pair<dev_t, ino_t>, std::size_t> robot_of;
  for (const auto& [links, entry] : ranked) {
    struct stat folder {};
    // One that is gone meanwhile is told of when it is read.
    const bool known = ::stat(entry.c_str(), &folder) == 0 &&
                       !robot_of.try_emplace({folder.st_dev, folder.st_ino}, robots.size()).second;
    if (known) {
      robots[robot_of.at({folder.st_dev, folder.st_ino})].links.push_back(entry.filename().string());
    } else {
      robots.push_back({entry, {}});
    }
  }
  return robots;
}

// What lies in a mission and is nobody's: mkfs makes lost+found at the top of a disk, for root alone.
bool is_of_no_robot(const std::string& name) { return name.starts_with('.') || name == "lost+found"; }

// No robot is left out without a word, whatever keeps it from being read.
tl::unexpected<Error> refuse_neighbour(Error error) {
  if (error.hint.empty()) error.hint = "let it be read, or name the robots one by one: NAME=PATH";
  return pass_up(std::move(error));
}

struct RobotsInside {
  std::vector<Inside> robots;
  std::vector<std::string> left_out;  // names of folders of other kinds than theirs, and of bags
};

// Robot folders among a folder's folders; if there are none, folders of any other kind.
Expected<RobotsInside> robots_inside(const fs::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  std::vector<fs::path> own;
  std::vector<fs::path> other;
  std::vector<fs::path> none;
  std::vector<std::string> left_out;
  for (const std::string& name : *names) {
    if (is_of_no_robot(name)) continue;
    const auto type = type_at(folder / name);
    if (!type) return refuse_neighbour(type.error());
    const SourceKind* kind = recognise(folder / name);
    if (*type != fs::file_type::directory) {
      if (kind != nullptr && kind->has_topics) left_out.push_back(name);
      continue;
    }
    (kind == nullptr ? none : kind->open == open_robot_folder ? own : other).push_back(folder / name);
  }
  if (!own.empty()) {
    none.insert(none.end(), other.begin(), other.end());
    for (const fs::path& path : other) left_out.push_back(path.filename().string());
  }
  for (const fs::path& passed_over : none) {
    if (auto ok = check_holds_no_robot(passed_over); !ok) return refuse_neighbour(ok.error());
  }
  return RobotsInside{each_once(own.empty() ? other : own), std::move(left_out)};
}

bool is_mission(const fs::path& path) {
  if (!is_folder(path)) return false;
  const auto robots = robots_inside(path);
  return robots && !robots->robots.empty();
}

// A bag, a tree, a whole map.
bool is_source_file(const fs::path& path) {
  const SourceKind* kind = is_file(path) ? recognise(path) : nullptr;
  return kind != nullptr && kind->open != refuse_foreign_file;
}

// What of a folder's content should have been named instead of it.
std::vector<std::string> find_inside(const fs::path& folder, bool (*is_wanted)(const fs::path&)) {
  constexpr std::size_t kMostLookedAt = 32;
  std::vector<std::string> found;
  const auto names = list_folder(folder);
  for (std::size_t i = 0; names && i < std::min(names->size(), kMostLookedAt); ++i) {
    const fs::path inside = folder / (*names)[i];
    if (!(*names)[i].starts_with('.') && is_wanted(inside)) found.push_back(shown(inside));
  }
  return found;
}

// A folder of scans is named more often than the one above it that has the poses.
tl::unexpected<Error> refuse_folder(const fs::path& path) {
  const auto clouds = list_clouds_of(path);
  if (clouds) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{} cloud{} in it ({}), but no list of poses beside them", clouds->size(),
                            clouds->size() == 1 ? "" : "s", some_of(*clouds)),
                shown(path),
                "put poses.txt there with lines `t x y z qx qy qz qw`, one for each cloud in order, or name the folder "
                "above if the poses are there");
  }
  const std::string what = "no robot: neither it nor a folder in it holds scans/ or submaps/";
  if (const auto missions = find_inside(path, is_mission); !missions.empty()) {
    return fail(ErrorCode::kEmptyInput, what, shown(path),
                "one level further down there are robots, in " + some_of(missions));
  }
  if (clouds.error().code != ErrorCode::kEmptyInput) return pass_up(clouds.error());
  if (const auto files = find_inside(path, is_source_file); !files.empty()) {
    return fail(ErrorCode::kEmptyInput, what, shown(path),
                "files are named one by one, each a robot: " + some_of(files));
  }
  return fail(ErrorCode::kEmptyInput, what, shown(path), known_kinds());
}

Expected<void> check_topics(const FoundRobot& robot) {
  if (robot.topics.empty() || robot.kind->has_topics) return {};
  return fail(ErrorCode::kUsage,
              fmt::format("#{} names a topic, but this is a {}, not a bag", printable(robot.topics.front(), 80),
                          robot.kind->name),
              shown(robot.path));
}

Expected<std::vector<FoundRobot>> robots_of_named(const std::string& name, const PathAndTopics& parts) {
  const fs::path& path = parts.path;
  if (const auto fault = find_fault(name)) {
    return fail(ErrorCode::kUsage, fmt::format("\"{}\" cannot be a robot's name: {}", printable(name, 80), *fault));
  }
  if (auto type = type_at(path); !type) {
    if (type.error().hint.empty() && type.error().code == ErrorCode::kNotFound) {
      type.error().hint = fmt::format("a folder whose own name has a '=' is written ./{}=...", printable(name, 80));
    }
    return pass_up(std::move(type.error()));
  }
  const SourceKind* kind = recognise(path);
  if (kind == nullptr && !is_folder(path)) return refuse_file(path);
  if (kind == nullptr) {
    if (is_result(path)) return refuse_result(path);
    if (auto ok = check_holds_no_robot(path); !ok) return pass_up(ok.error());
    const auto clouds = list_clouds_of(path);
    if (clouds || clouds.error().code != ErrorCode::kEmptyInput) return refuse_folder(path);
    if (const auto inside = robots_inside(path); inside && !inside->robots.empty()) {
      std::vector<std::string> names;
      for (const Inside& robot : inside->robots) names.push_back(robot.path.filename().string());
      return fail(ErrorCode::kNotFound, "a mission, where NAME= expects one robot", shown(path),
                  fmt::format("its robots are {}: {}={} takes the first, the path alone all of them", some_of(names),
                              printable(name, 80), shown(path / names.front())));
    }
    return fail(ErrorCode::kNotFound, "expected scans/ or submaps/ in it, or another kind of source, found neither",
                shown(path), known_kinds());
  }
  return std::vector<FoundRobot>{{name, path, kind, parts.topics, {}, 0, {}}};
}

Expected<std::vector<FoundRobot>> robots_of_path(const PathAndTopics& parts) {
  const fs::path& path = parts.path;
  if (const auto type = type_at(path); !type) return pass_up(type.error());
  std::vector<Inside> candidates;
  std::vector<std::string> left_out;
  if (recognise(path) != nullptr) {
    candidates.push_back({path, {}});
  } else if (!is_folder(path)) {
    return refuse_file(path);
  } else {
    auto inside = robots_inside(path);
    if (!inside) return pass_up(inside.error());
    candidates = std::move(inside->robots);
    left_out = std::move(inside->left_out);
  }
  if (candidates.empty()) {
    if (is_result(path)) return refuse_result(path);
    if (auto ok = check_holds_no_robot(path); !ok) return pass_up(ok.error());
    return refuse_folder(path);
  }
  std::vector<FoundRobot> robots;
  for (Inside& candidate : candidates) {
    Expected<FoundRobot> robot = robot_from_path(candidate.path, *recognise(candidate.path));
    if (!robot) return pass_up(robot.error());
    robot->links = std::move(candidate.links);
    robot->topics = parts.topics;
    robots.push_back(*std::move(robot));
  }
  robots.front().left_out = std::move(left_out);
  return robots;
}

// Of NAME=PATH the name; absent where the whole is a path.
std::optional<std::string> name_before_path(const std::string& source) {
  const std::size_t equals = source.find('=');
  if (equals == std::string::npos || source.find('/') < equals) return std::nullopt;
  return source.substr(0, equals);
}

Expected<std::vector<FoundRobot>> robots_of_source(const std::string& source) {
  // Most often a variable of a script that was never set.
  if (source.empty() || (source.ends_with('=') && source.find('/') == std::string::npos)) {
    return fail(ErrorCode::kUsage, "expected a path, found none", fmt::format("source \"{}\"", printable(source, 80)),
                "a folder or a file, or NAME=PATH");
  }
  if (const auto name = name_before_path(source)) {
    return robots_of_named(*name, split_topics(source.substr(name->size() + 1)));
  }
  return robots_of_path(split_topics(source));
}

tl::unexpected<Error> given_twice(const std::string& name, const std::string& first, const std::string& second) {
  return fail(ErrorCode::kUsage, fmt::format("robot \"{}\" is given twice: {} and {}", name, first, second), {},
              "give one of them another name: NAME=PATH");
}

// Before anything is looked for: what the words alone tell is a wrong command, whatever lies on the disk.
Expected<void> check_names_differ(const std::vector<std::string>& sources) {
  std::map<std::string, std::string> first_of;
  for (const std::string& source : sources) {
    const auto name = name_before_path(source);
    if (!name) continue;
    const auto [first, is_new] = first_of.try_emplace(*name, source);
    if (!is_new) return given_twice(printable(*name, 80), printable(first->second, 200), printable(source, 200));
  }
  return {};
}

}  // namespace

std::string known_kinds() {
  std::string text = "kilter reads a folder with poses.* and scans/ or submaps/";
  for (const SourceKind& kind : source_kinds()) {
    if (kind.open == open_robot_folder || kind.open == refuse_foreign_file) continue;
    text += fmt::format(", {}", kind.name);
  }
  return text + ", and a folder of any of them, one for each robot";
}

Expected<std::vector<FoundRobot>> find_robots(const std::vector<std::string>& sources) {
  if (auto ok = check_names_differ(sources); !ok) return pass_up(ok.error());
  std::vector<FoundRobot> robots;
  for (std::size_t source = 0; source < sources.size(); ++source) {
    auto found = robots_of_source(sources[source]);
    if (!found) return pass_up(found.error());
    for (FoundRobot& robot : *found) {
      if (auto ok = check_topics(robot); !ok) return pass_up(ok.error());
      robot.source = source;
    }
    std::move(found->begin(), found->end(), std::back_inserter(robots));
  }
  std::sort(robots.begin(), robots.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  const auto twice =
      std::adjacent_find(robots.begin(), robots.end(), [](const auto& a, const auto& b) { return a.name == b.name; });
  if (twice != robots.end()) {
    return given_twice(twice->name, shown(twice->path), shown(std::next(twice)->path));
  }
  return robots;
}

}  // namespace kilter
