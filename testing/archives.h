// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/io/archive.h"

namespace kilter_testing {

/// Robots a and b with a submap each and the pair between them: every part of an archive, as small as can be.
inline kilter::Archive small_archive(const std::string& robot = "b") {
  kilter::Archive archive;
  archive.json = R"({"schema": "kilter.result/1", "robots": [{"name": "a"}, {"name": ")" + robot +
                 R"("}], "submaps": [{"id": "a/1"}, {"id": "b/1"}], "pairs": [{"target": "a/1", "source": "b/1"}]})";
  kilter::Picture& picture = archive.picture;
  picture.paths = {{{0.0, 0.0, 0.0}, {1.0, 0.5, 0.0}}, {{2.0, 0.0, 0.25}}};
  for (const int points : {5, 4}) {
    kilter::CloudPicture cloud;
    cloud.voxels = 9;
    cloud.origin_m = {-1.0, -2.0, -0.5};
    cloud.step_m = 0.001;
    for (int i = 0; i < points; ++i) {
      cloud.points.push_back({static_cast<std::uint16_t>(1000 * i), static_cast<std::uint16_t>(65535 - i), 7});
      cloud.misalignment.push_back(static_cast<std::uint8_t>(50 * i));
    }
    picture.clouds.push_back(cloud);
  }
  kilter::PairPicture pair;
  pair.id = {{1}, {0}};
  pair.centre_world_m = {0.5, 0.25, 0.0};
  pair.stride = 2;
  pair.source = {{0, 128}, {127, 3}};
  pair.target = {{1, 2, 126}, {4, 5, 255}};
  pair.registered_histogram = kilter::DistanceHistogram{0.01, {3, 0, 9}};
  pair.registered_parent = kilter::NormalParent{0.02, 0.03};
  picture.pairs = {pair};
  return archive;
}

}  // namespace kilter_testing
