// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/earlier_mission.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kilter/io/file.h"
#include "kilter/simulation/scene.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

fs::file_type type_of(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type();
}

tl::unexpected<Error> refuse(const fs::path& path) {
  return fail(ErrorCode::kUsage,
              type_of(path) == fs::file_type::symlink
                  ? "this is a symlink, and simulate makes none; it is left alone"
                  : "nothing in truth/ says that simulate wrote this; it is left alone",
              shown(path), "move it away, or choose another folder");
}

constexpr fs::file_type kFile = fs::file_type::regular;
constexpr fs::file_type kFolder = fs::file_type::directory;
constexpr fs::file_type kNothing = fs::file_type::not_found;

// Nothing in a folder but entries of the type that `type_in_ours` tells by their names, kNothing where we make none.
template <typename TypeInOurs>
Expected<void> expect_only_ours(const fs::path& folder, const TypeInOurs& type_in_ours) {
  if (type_of(folder) == kNothing) return {};
  if (type_of(folder) != kFolder) return refuse(folder);
  const Expected<std::vector<std::string>> names = list_folder(folder);
  if (!names) return pass_up(names.error());
  for (const std::string& name : *names) {
    if (type_of(folder / name) != type_in_ours(name)) return refuse(folder / name);
  }
  return {};
}

// "000012.bin" of more than twelve, say.
bool is_scan(const std::string& name, const char* extension, std::size_t count) {
  const std::size_t number = std::strtoull(name.c_str(), nullptr, 10);
  return number < count && name == fmt::format("{:06}{}", number, extension);
}

Expected<void> check_robot(const fs::path& folder, const std::string& robot) {
  const fs::path poses = folder / "truth" / robot / "poses.tum";
  const fs::path own = folder / "mission" / robot;
  const auto type_in_truth = [](const std::string& name) { return name == "poses.tum" ? kFile : kNothing; };
  if (auto fit = expect_only_ours(poses.parent_path(), type_in_truth); !fit) return fit;
  if (type_of(own) == kNothing) return {};
  if (type_of(poses) != kFile) return refuse(own);
  const Expected<ByteBuffer> text = read_file(poses);
  if (!text) return pass_up(text.error());
  const std::string_view lines = text->view();
  const auto count = static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
  const auto type_in_own = [](const std::string& name) {
    return name == "scans" ? kFolder : name == "poses.tum" ? kFile : kNothing;
  };
  if (auto fit = expect_only_ours(own, type_in_own); !fit) return fit;
  const char* extension = type_of(own / "scans" / "000000.pcd") == kFile ? ".pcd" : ".bin";
  return expect_only_ours(own / "scans",
                          [&](const std::string& name) { return is_scan(name, extension, count) ? kFile : kNothing; });
}

Expected<void> check_ours(const fs::path& folder) {
  const auto type_in_mission = [](const std::string& name) {
    return name.size() == 1 && kRobotNames.find(name) != std::string_view::npos ? kFolder : kNothing;
  };
  const auto type_in_truth = [&](const std::string& name) {
    return name == "faults.json" ? kFile : type_in_mission(name);
  };
  if (auto fit = expect_only_ours(folder / "mission", type_in_mission); !fit) return fit;
  if (auto fit = expect_only_ours(folder / "truth", type_in_truth); !fit) return fit;
  for (const char robot : kRobotNames) {
    if (auto fit = check_robot(folder, std::string(1, robot)); !fit) return fit;
  }
  return {};
}

// Recordings may stand in a folder of the same name.
bool is_simulated(const fs::path& folder) {
  const Expected<ByteBuffer> faults = read_file(folder / "truth" / "faults.json");
  return faults && faults->view().find(kFaultsSchema) != std::string_view::npos;
}

}  // namespace

Expected<void> check_room_for_mission(const fs::path& folder, bool replace) {
  for (const char* part : {"truth", "mission"}) {
    const fs::path path = folder / part;
    if (type_of(path) == fs::file_type::not_found) continue;
    if (!replace) {
      return fail(ErrorCode::kUsage, "there is a mission already", shown(path), "choose another folder, or --replace");
    }
    if (is_simulated(folder)) return check_ours(folder);
    return fail(ErrorCode::kUsage,
                "this is no mission of simulate's, which has a truth/faults.json beside it; it is left alone",
                shown(path), "choose another folder");
  }
  return {};
}

}  // namespace kilter
