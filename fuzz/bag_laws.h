// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kilter/io/bags/bag_log.h"
#include "kilter/io/bags/decompress.h"
#include "kilter/io/pose_reader.h"
#include "reader_laws.h"

namespace kilter_fuzz {

/// A bag is refused with a printable reason, or is a robot: sound poses, as many stamps, clouds that can be read or
/// not.
inline void demand_lawful_bag(kilter::Expected<std::unique_ptr<kilter::BagReader>> reader, std::size_t file_bytes) {
  if (!reader) return demand_printable(reader.error());
  kilter::BagFiles files;
  files.push_back(*std::move(reader));
  std::vector<std::string> notes;
  const auto log = kilter::make_bag_log("fuzz", std::move(files), {}, "fuzz", notes);
  for (const std::string& note : notes) demand(kilter::printable(note, note.size()) == note);
  if (!log) return demand_printable(log.error());
  demand(!log->T_world_cloud.empty() && log->T_world_cloud.size() == log->stamps_ns.size());
  demand(log->T_world_cloud.size() <= log->clouds_found);
  const std::size_t at_most = kilter::kFreeUnpackedBytes + kilter::kMaxUnpackedRatio * file_bytes;
  for (std::size_t i = 0; i < log->T_world_cloud.size(); ++i) {
    // A chain of transforms may lead a little beyond the bound of each.
    demand(log->T_world_cloud[i].translation_m().cwiseAbs().maxCoeff() <= 130 * kilter::kMaxPosition_m);
    demand(std::abs(log->T_world_cloud[i].rotation().norm() - 1.0) < 1e-9);
    demand(log->cloud_name(i).starts_with("fuzz"));
    if (i < 16) demand_usable(log->read_cloud(i), at_most);
  }
}

}  // namespace kilter_fuzz
