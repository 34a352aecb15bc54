// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any file beside clouds is refused with a printable reason, or gives poses, each with a stamp, an id and a name or
// none of them with one.
#include <cmath>

#include "kilter/io/pose_list.h"
#include "kilter/io/pose_reader.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto list = kilter::read_pose_list(kilter_fuzz::text_of(data, size), "fuzz");
  if (!list) {
    kilter_fuzz::demand_printable(list.error());
    return 0;
  }
  const std::size_t count = list->T_world_cloud.size();
  const auto none_or_all = [count](std::size_t found) { kilter_fuzz::demand(found == 0 || found == count); };
  kilter_fuzz::demand(count > 0);
  none_or_all(list->stamps.size());
  none_or_all(list->ids.size());
  none_or_all(list->files.size());
  for (const kilter::Pose3& pose : list->T_world_cloud) {
    kilter_fuzz::demand(pose.translation_m().cwiseAbs().maxCoeff() <= kilter::kMaxPosition_m);
    kilter_fuzz::demand(std::abs(pose.rotation().norm() - 1.0) < 1e-12);
  }
  for (const std::string& file : list->files) kilter_fuzz::demand(file.find('/') == std::string::npos);
  if (const auto stamps_ns = kilter::stamps_ns_of(*list)) {
    for (const std::int64_t stamp_ns : *stamps_ns) kilter_fuzz::demand(stamp_ns >= 0);
  }
  return 0;
}
