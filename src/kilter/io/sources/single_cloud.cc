// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/single_cloud.h"

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"

namespace kilter {

bool is_single_cloud(const std::filesystem::path& file) {
  const std::optional<CloudFormat> format = cloud_format_of(file.filename().native());
  return format && *format != CloudFormat::kBin && is_file(file);
}

Expected<RobotLog> open_single_cloud(const SourceRequest& request, std::vector<std::string>& /*notes*/) {
  RobotLog log;
  log.name = request.name;
  log.finished_submaps = true;
  log.T_world_cloud.emplace_back();
  read_from_files(log, {request.path});
  return log;
}

}  // namespace kilter
