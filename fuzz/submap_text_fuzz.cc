// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Text beside a submap, a key frame or a sequence (GLIM's data.txt, hdl_graph_slam's data, KITTI's calib.txt; the first
// byte chooses) is refused with a printable reason, or gives rigid poses. A fourth choice reads GLIM's points.
#include <cmath>

#include "kilter/io/pose_reader.h"
#include "kilter/io/sources/glim_dump.h"
#include "kilter/io/sources/hdl_dump.h"
#include "kilter/io/sources/kitti_sequence.h"
#include "reader_laws.h"

namespace {

void demand_rigid(const kilter::Pose3& pose) {
  kilter_fuzz::demand(pose.translation_m().cwiseAbs().maxCoeff() <= kilter::kMaxPosition_m);
  kilter_fuzz::demand(std::abs(pose.rotation().norm() - 1.0) < 1e-12);
}

template <typename T>
bool is_good(const kilter::Expected<T>& result) {
  if (!result) kilter_fuzz::demand_printable(result.error());
  return result.has_value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text = kilter_fuzz::text_of(data + 1, size - 1);
  if (data[0] == 'g') {
    const auto submap = kilter::parse_glim_submap(text, "fuzz");
    if (is_good(submap)) demand_rigid(submap->T_world_origin);
  } else if (data[0] == 'h') {
    const auto frame = kilter::parse_hdl_key_frame(text, "fuzz");
    if (is_good(frame) && frame->estimate) demand_rigid(*frame->estimate);
    if (frame && frame->odom) demand_rigid(*frame->odom);
  } else if (data[0] == 'k') {
    const auto pose = kilter::parse_kitti_calibration(text, "fuzz");
    if (is_good(pose)) demand_rigid(*pose);
  } else {
    kilter_fuzz::demand_usable(kilter::read_glim_points(text, data[0] % 2 == 0, "fuzz"), size);
  }
  return 0;
}
