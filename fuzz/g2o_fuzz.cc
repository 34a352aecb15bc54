// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text named *.g2o is refused with a printable reason, or gives poses with ids that ascend.
#include <cmath>

#include "kilter/io/g2o_reader.h"
#include "kilter/io/pose_reader.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto vertices = kilter::read_g2o_vertices(kilter_fuzz::text_of(data, size), "fuzz");
  if (!vertices) {
    kilter_fuzz::demand_printable(vertices.error());
    return 0;
  }
  kilter_fuzz::demand(!vertices->empty());
  for (std::size_t i = 0; i < vertices->size(); ++i) {
    const kilter::NumberedPose& vertex = (*vertices)[i];
    kilter_fuzz::demand(i == 0 || (*vertices)[i - 1].id < vertex.id);
    kilter_fuzz::demand(vertex.T_world_cloud.translation_m().cwiseAbs().maxCoeff() <= kilter::kMaxPosition_m);
    kilter_fuzz::demand(std::abs(vertex.T_world_cloud.rotation().norm() - 1.0) < 1e-12);
  }
  return 0;
}
