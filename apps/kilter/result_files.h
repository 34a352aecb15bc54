// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/kilter/output_folder.h"
#include "kilter/pipeline/result.h"
#include "kilter/report/constraints_g2o.h"
#include "kilter/report/result_json.h"

namespace kilter::app {

/// What the files of a result need besides it.
struct ResultFormats {
  std::string json;  ///< of result.json
  ConfigEcho config;
  double tolerance_m = 0.1;
  G2oDialect g2o_dialect = G2oDialect::kG2o;
};

/// What result_files may be called, for a look at the folder before any work. \param maps  names of the fused maps
[[nodiscard]] std::vector<std::filesystem::path> result_file_names(const std::vector<std::string>& maps);

/// All files of the output folder: result.kilter before all others that are not in maps/, since it says that they are
/// ours; result.json last: who finds a new one finds the rest new as well.
/// \param notes  gets one for each fused map that no octree can hold
[[nodiscard]] std::vector<OutputFile> result_files(const Result& result, const ResultFormats& formats,
                                                   std::vector<std::string>& notes);

}  // namespace kilter::app
