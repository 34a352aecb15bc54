// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/option_table.h"
#include "kilter/consistency/distribution.h"
#include "kilter/consistency/gamma.h"
#include "kilter/matching/distances.h"
#include "kilter/pairing/propose_pairs.h"
#include "kilter/pipeline/picture.h"
#include "kilter/pipeline/result.h"
#include "kilter/pipeline/spill_space.h"
#include "kilter/registration/registration.h"
#include "kilter/submap/build_submaps.h"
#include "kilter/verification/judge.h"

namespace kilter {

/// Every option that can change a result, by stage.
struct CheckOptions {
  SubmapOptions submap;
  PairingOptions pairing;
  MatchingOptions matching;
  DistributionOptions distribution;
  GammaOptions gamma;
  RegistrationOptions registration;
  JudgeOptions judge;
  PictureOptions picture;
};

/// One flat table of all keys, in the order of the stages; each name occurs once. Values that several stages share
/// (d, gates, resolution) have one key; `check` hands them on.
[[nodiscard]] std::vector<OptionField> fields(CheckOptions& options);

/// What options cannot mean: those of occupancy, a `d` below a voxel, and one above 200, for the search for the nearest
/// voxel knows every block within its reach, so that time and memory grow with its cube. \return  kConfig with the key.
[[nodiscard]] Expected<void> validate(const CheckOptions& options);

/// The paper and nothing of ours: OICP registration, moments then truncation, no floor, literal Eq. (8) weights.
void apply_seed_preset(CheckOptions& options);

/// How one run of `check` goes about it; none of this changes the result.
struct CheckRun {
  int threads = 1;
  const std::atomic<bool>* cancelled = nullptr;
  std::size_t memory_bytes = 0;  ///< what submaps and their searches may take in memory; 0 = no limit
  SpillSpace* spill = nullptr;   ///< where the others wait; null = all must fit. Must outlive the run
  bool fuse_maps = false;        ///< --maps
  bool draw_picture = false;     ///< fill Result::picture
  /// Told (stage, done, total) from any thread, in no promised order; may be empty.
  std::function<void(std::string_view stage, std::size_t done, std::size_t total)> progress = {};
};

/// The main job, as the paper's Algorithm 1: submaps, pairs, Gamma, registration, Theta, Gamma^v, verdicts.
///
/// \param robots  sorted bytewise by name; at least one.
/// \param cuts    ranges of scans by robot name to use instead of cutting; empty = cut. Robots not named are cut.
/// \return the result; or the reading error of the first scan that fails; kOutOfMemory where two submaps of a pair (all
///   of them, without spill space) are beyond the budget, kNoSpace; kCancelled.
/// Same bits for every number of threads and every budget.
[[nodiscard]] Expected<Result> check(const std::vector<RobotLog>& robots, const CheckOptions& asked,
                                     const std::map<std::string, std::vector<ScanRange>>& cuts, const CheckRun& run);

}  // namespace kilter
