// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_file.h"

#include <fmt/format.h>

#include "kilter/io/file.h"

namespace kilter {

Expected<std::filesystem::path> find_pose_file(const std::filesystem::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  std::vector<std::string> found;
  for (const std::string& name : *names) {
    // A link that leads nowhere was meant to be one.
    if (name.starts_with("poses.") && !is_folder(folder / name)) found.push_back(name);
  }
  if (found.size() == 1) {
    if (auto ok = expect_file(folder / found.front()); !ok) return pass_up(ok.error());
    return folder / found.front();
  }
  if (found.empty()) {
    return fail(ErrorCode::kNotFound, "expected a file poses.*, found none", shown(folder),
                "one pose T_world_sensor per scan, e.g. poses.tum with lines `t x y z qx qy qz qw`");
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("expected one file poses.*, found {}: {}", found.size(), some_of(found)), shown(folder),
              "move the others away, or name the wanted ones by --poses");
}

Expected<PoseList> read_pose_file(const std::filesystem::path& path) {
  const auto bytes = read_file(path, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  return read_pose_list(bytes->view(), shown(path));
}

}  // namespace kilter
