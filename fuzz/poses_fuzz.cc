// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text named poses.* is refused with a printable reason, or gives finite poses with rotations.
#include <cmath>

#include "kilter/io/pose_reader.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto poses = kilter::read_poses(kilter_fuzz::text_of(data, size), "fuzz");
  if (!poses) {
    kilter_fuzz::demand_printable(poses.error());
    return 0;
  }
  kilter_fuzz::demand(!poses->empty());
  for (const kilter::Pose3& pose : *poses) {
    kilter_fuzz::demand(pose.translation_m().cwiseAbs().maxCoeff() <= kilter::kMaxPosition_m);
    kilter_fuzz::demand(std::abs(pose.rotation().norm() - 1.0) < 1e-12);
  }
  return 0;
}
