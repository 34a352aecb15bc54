// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/missed_robot.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/sources/cloud_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

bool is_named_like_poses(const std::string& name) { return name.starts_with("poses."); }

bool is_named_like_clouds(const std::string& name) {
  const std::string lower = lower_case(name);
  return lower == "scans" || lower == "submaps";
}

// Names can be listed where nothing behind them can be reached.
Expected<void> check_can_be_entered(const fs::path& folder) {
  const auto type = type_at(folder / ".");
  if (type) return {};
  Error error = type.error();
  error.where = shown(folder);
  return pass_up(std::move(error));
}

// What of a folder only a robot has. \return its names; or why one of them is not what it is called.
Expected<std::vector<std::string>> find_traces(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& name : names) {
    const fs::path path = folder / name;
    if (is_named_like_clouds(name)) {
      if (auto ok = expect_folder(path); !ok) return pass_up(ok.error());
      found.push_back(name + '/');
    } else if (is_named_like_poses(name) && !is_folder(path)) {
      if (auto ok = expect_file(path); !ok) return pass_up(ok.error());
      found.push_back(name);
    } else if (name == "velodyne") {
      // A sequence whose scans lie on another disk.
      if (auto ok = expect_folder(path); !ok) return pass_up(ok.error());
    }
  }
  return found;
}

}  // namespace

Expected<void> check_holds_no_robot(const fs::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  if (auto ok = check_can_be_entered(folder); !ok) return ok;
  const auto traces = find_traces(folder, *names);
  if (!traces) return pass_up(traces.error());
  if (traces->empty()) return {};
  const auto clouds = list_clouds_of(folder);
  if (!clouds && clouds.error().code != ErrorCode::kEmptyInput) return pass_up(clouds.error());
  return fail(ErrorCode::kNotFound,
              fmt::format("expected scans/ or submaps/, spelt so, found {} without either", some_of(*traces)),
              shown(folder), "call the folder of clouds scans; if this is no robot, name the robots one by one");
}

}  // namespace kilter
