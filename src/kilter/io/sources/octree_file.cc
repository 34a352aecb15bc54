// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/octree_file.h"

#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/octree_reader.h"

namespace kilter {

bool is_octree_file(const std::filesystem::path& path) {
  return has_octree_name(path.filename().native()) && is_file(path);
}

Expected<RobotLog> open_octree_file(const SourceRequest& request, std::vector<std::string>& /*notes*/) {
  RobotLog log;
  log.name = request.name;
  log.finished_submaps = true;
  log.T_world_cloud.emplace_back();
  if (auto ok = read_from_octrees(log, {request.path}); !ok) return pass_up(ok.error());
  return log;
}

}  // namespace kilter
