// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/usable_points.h"

#include <fmt/format.h>

#include <optional>

namespace kilter {

Expected<void> check_usable(const PointCloud& cloud, const std::string& where) {
  if (!cloud.points_m.empty()) return {};
  const std::size_t all = cloud.dropped_nonfinite + cloud.dropped_far;
  if (all == 0) {
    return fail(ErrorCode::kInvalidPoints, "expected points, found none", where, "look at the program that wrote it");
  }
  std::string why;
  if (cloud.dropped_nonfinite > 0) why = fmt::format("{} are not finite", cloud.dropped_nonfinite);
  if (cloud.dropped_far > 0) {
    why += fmt::format("{}{} lie beyond {} m from the origin", why.empty() ? "" : ", ", cloud.dropped_far,
                       PointCloud::kMaxCoordinate_m);
  }
  return fail(ErrorCode::kInvalidPoints, fmt::format("none of its {} points can be used: {}", all, why), where,
              cloud.dropped_far > 0 ? "georeferenced? subtract one offset from all points and add it to the poses; in "
                                      "millimetres? write metres"
                                    : "look at the program that wrote it");
}

Expected<void> check_usable(const RobotLog& robot) {
  if (!robot.read_cloud || robot.read_cells) return {};
  std::optional<Error> first;
  for (std::size_t i = 0; i < robot.T_world_cloud.size(); ++i) {
    const Expected<PointCloud> cloud = robot.read_cloud(i);
    if (!cloud) return {};
    const Expected<void> usable = check_usable(*cloud, robot.cloud_name(i));
    if (usable) return {};
    if (!first) first = usable.error();
  }
  if (!first) return {};
  if (robot.T_world_cloud.size() > 1) {
    first->message +=
        fmt::format("; it is so with all {} clouds of robot {}", robot.T_world_cloud.size(), printable(robot.name));
  }
  return pass_up(*std::move(first));
}

}  // namespace kilter
