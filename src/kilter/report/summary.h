// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter {

/// How the summary is told.
struct SummaryOptions {
  double tolerance_m = 0.1;                  ///< that the verdicts are about
  bool papers_test = false;                  ///< verdicts rest on Gamma alone, which knows no tolerance
  bool colour = false;                       ///< ANSI colours; nothing is said by colour alone
  std::vector<std::string> sources;          ///< what was recognised, e.g. "GLIM dump, 214 submaps, 1 robot"
  std::string output_folder = "kilter-out";  ///< where the files are, for what to do next
  std::optional<std::string> poses;          ///< --poses, which what is done next needs as well
  std::string odd;                           ///< of the input, that comes before all else: "millimetres of robot a"
};

inline constexpr int kSummaryLines = 26;     ///< at most
inline constexpr int kSummaryColumns = 100;  ///< at most, colour codes not counted

/// The result as a person reads it at the end of a run: plain text, the verdict first, then what it rests on, the five
/// worst pairs, what was left out and what to do next.
///
/// Worst are the inconsistent pairs; of these, and of the others, those whose registration is believed; by offset. A
/// pair's row shows its RMS offset with the 95 % interval, the rotation, and the *shift*: how far the source submap
/// would have to move, along x, y and z of the world frame, to lie where registration finds it (offset_vector turned
/// from the target's axes by the map's pose), or that it is not known where that registration is not believed.
[[nodiscard]] std::string summary(const Result& result, const SummaryOptions& options = {});

}  // namespace kilter
