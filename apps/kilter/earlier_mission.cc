// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/earlier_mission.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kilter/io/file.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

fs::file_type type_of(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type();
}

tl::unexpected<Error> refuse(const fs::path& path, const char* message) {
  return fail(ErrorCode::kUsage, message, shown(path), "move it away, or choose another folder");
}

// Nothing in a folder but entries that `is_ours` knows.
template <typename IsOurs>
Expected<void> expect_only_ours(const fs::path& folder, const IsOurs& is_ours) {
  if (type_of(folder) == fs::file_type::not_found) return {};
  if (type_of(folder) != fs::file_type::directory) return refuse(folder, "this is not what simulate wrote");
  const Expected<std::vector<std::string>> names = list_folder(folder);
  if (!names) return pass_up(names.error());
  for (const std::string& name : *names) {
    if (!is_ours(name)) return refuse(folder / name, "simulate did not write this; it is left alone");
  }
  return {};
}

bool is_scan(const std::string& name, std::size_t count) {
  std::size_t number = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), number);
  return status == std::errc() && number < count &&
         (name == fmt::format("{:06}.bin", number) || name == fmt::format("{:06}.pcd", number));
}

Expected<void> check_robot(const fs::path& folder, const std::string& robot) {
  const fs::path poses = folder / "truth" / robot / "poses.tum";
  const fs::path own = folder / "mission" / robot;
  const auto is_pose_file = [](const std::string& name) { return name == "poses.tum"; };
  if (auto fit = expect_only_ours(poses.parent_path(), is_pose_file); !fit) return fit;
  if (type_of(own) == fs::file_type::not_found) return {};
  if (type_of(poses) != fs::file_type::regular) return refuse(own, "simulate did not write this; it is left alone");
  const Expected<ByteBuffer> text = read_file(poses);
  if (!text) return pass_up(text.error());
  const std::string_view lines = text->view();
  const auto count = static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
  const auto is_entry = [](const std::string& name) { return name == "scans" || name == "poses.tum"; };
  if (auto fit = expect_only_ours(own, is_entry); !fit) return fit;
  return expect_only_ours(own / "scans", [&](const std::string& name) {
    return is_scan(name, count) && type_of(own / "scans" / name) == fs::file_type::regular;
  });
}

Expected<void> check_ours(const fs::path& folder) {
  const auto is_robot = [](const std::string& name) { return name.size() == 1 && name[0] >= 'a' && name[0] <= 'e'; };
  const auto is_truth = [&](const std::string& name) { return is_robot(name) || name == "faults.json"; };
  if (auto fit = expect_only_ours(folder / "mission", is_robot); !fit) return fit;
  if (auto fit = expect_only_ours(folder / "truth", is_truth); !fit) return fit;
  for (char robot = 'a'; robot <= 'e'; ++robot) {
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
