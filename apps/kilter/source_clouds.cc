// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/source_clouds.h"

#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "apps/kilter/output_folder.h"
#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

// Where a robot's clouds lie.
struct CloudPlaces {
  std::vector<fs::path> named;  // files that are sources themselves; what lies beside them does not matter
  std::set<fs::path> folders;   // of all others
};

CloudPlaces places_of(const RobotLog& robot, const std::vector<std::string>& sources) {
  CloudPlaces places;
  for (std::size_t i = 0; i < robot.T_world_cloud.size(); ++i) {
    const std::string cloud = robot.cloud_name(i);
    const auto names_it = [&](const std::string& source) { return source == cloud || source.ends_with('=' + cloud); };
    if (!is_file(cloud)) continue;  // a message of a bag
    if (std::any_of(sources.begin(), sources.end(), names_it)) {
      places.named.emplace_back(cloud);
    } else {
      places.folders.insert(fs::path(cloud).parent_path());
    }
  }
  return places;
}

}  // namespace

Expected<void> check_apart_from_clouds(const fs::path& folder, const std::vector<fs::path>& names,
                                       const std::vector<std::string>& sources, const Mission& mission) {
  std::set<fs::path> outputs;
  for (const fs::path& name : names) outputs.insert((folder / name).parent_path());
  for (const RobotLog& robot : mission.robots) {
    const CloudPlaces places = places_of(robot, sources);
    for (const fs::path& name : names) {
      if (auto fit = check_output_file(folder / name, name.extension().native(), places.named); !fit) return fit;
    }
    for (const fs::path& output : outputs) {
      std::error_code error;
      const auto is_here = [&](const fs::path& clouds) { return fs::equivalent(output, clouds, error); };
      if (std::none_of(places.folders.begin(), places.folders.end(), is_here)) continue;
      return fail(ErrorCode::kUsage, fmt::format("the clouds of robot {} lie here", printable(robot.name)),
                  "-o " + shown(output), "name another folder with -o");
    }
  }
  return {};
}

}  // namespace kilter::app
