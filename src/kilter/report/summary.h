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

inline constexpr int kSummaryLines = 30;     ///< at most
inline constexpr int kSummaryColumns = 100;  ///< at most, colour codes not counted

/// The result as a person reads it at the end of a run: plain text, the verdict first, then what it rests on, the five
/// worst pairs (worst_pair_lines), what was left out and what to do next.
[[nodiscard]] std::string summary(const Result& result, const SummaryOptions& options = {});

}  // namespace kilter
