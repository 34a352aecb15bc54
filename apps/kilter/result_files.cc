// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/result_files.h"

#include <array>
#include <map>

#include <fmt/format.h>

#include "kilter/io/archive.h"
#include "kilter/io/octree_writer.h"
#include "kilter/report/coloured_ply.h"
#include "kilter/report/map_ply.h"
#include "kilter/report/matrix_csv.h"
#include "kilter/report/pairs_csv.h"
#include "kilter/report/pictures_png.h"
#include "kilter/report/report_html.h"
#include "kilter/submap/fuse_submaps.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

using Cells = std::map<PairId, double>;

// What the files are made of.
struct Parts {
  const Result& result;
  const ResultFormats& formats;
  Cells gamma;
  Cells theta;
  Cells verified;
  std::string archive;  // the report is drawn from it
};

Parts parts_of(const Result& result, const ResultFormats& formats) {
  return {result,
          formats,
          gamma_matrix(result).entries(),
          theta_matrix(result).entries(),
          verified_matrix(result).entries(),
          archive_bytes({result_json_without_run(result, formats.config), *result.picture})};
}

std::vector<double> values_of(const Cells& cells) {
  std::vector<double> values;
  values.reserve(cells.size());
  for (const auto& [id, value] : cells) values.push_back(value);
  return values;
}

// Of Gamma and Theta alike, so that one colour means the same in both pictures.
std::vector<double> consistency_values(const Parts& parts) {
  std::vector<double> values = values_of(parts.gamma);
  for (const double value : values_of(parts.theta)) values.push_back(value);
  return values;
}

struct ResultFile {
  const char* name;
  std::string (*bytes)(const Parts& parts);
};

// result.kilter first: who is killed between two renames leaves files that are known for ours.
constexpr std::array kFiles = {
    ResultFile{"result.kilter", [](const Parts& p) { return p.archive; }},
    ResultFile{"pairs.csv", [](const Parts& p) { return pairs_csv(p.result); }},
    ResultFile{"gamma.csv", [](const Parts& p) { return matrix_csv(p.result, p.gamma); }},
    ResultFile{"theta.csv", [](const Parts& p) { return matrix_csv(p.result, p.theta); }},
    ResultFile{"verified.csv", [](const Parts& p) { return matrix_csv(p.result, p.verified); }},
    ResultFile{"constraints.g2o", [](const Parts& p) { return constraints_g2o(p.result, p.formats.g2o_dialect); }},
    ResultFile{"gamma.png", [](const Parts& p) { return matrix_png(p.result, p.gamma, consistency_values(p)); }},
    ResultFile{"theta.png", [](const Parts& p) { return matrix_png(p.result, p.theta, consistency_values(p)); }},
    ResultFile{"verified.png", [](const Parts& p) { return matrix_png(p.result, p.verified, values_of(p.verified)); }},
    ResultFile{"map.png", [](const Parts& p) { return map_png(p.result); }},
    ResultFile{"coloured.ply", [](const Parts& p) { return coloured_ply(p.result, p.formats.tolerance_m); }},
    ResultFile{"report.html", [](const Parts& p) { return report_html(p.archive); }},
    ResultFile{"result.json", [](const Parts& p) { return p.formats.json; }},
};

fs::path map_file(const std::string& map, const char* extension) { return fs::path("maps") / (map + extension); }

// A fused map for viewers and, where its voxels are near enough to the world's origin, for OctoMap.
void add_map(std::vector<OutputFile>& files, const FusedMap& map, const Result& result,
             std::vector<std::string>& notes) {
  files.push_back({map_file(map.name, ".ply"), map_ply(map, result.robots)});
  const fs::path tree = map_file(map.name, ".ot");
  const Expected<OccupancyCells> cells = cells_from_fused(map.voxels, result.resolution_m);
  if (cells) {
    files.push_back({tree, octree_bytes(*cells, OctreeFormat::kFull)});
  } else {
    notes.push_back(fmt::format("{} is not written: {}", printable(tree.native()), cells.error().message));
  }
}

}  // namespace

std::vector<fs::path> result_file_names(const std::vector<std::string>& maps) {
  std::vector<fs::path> names;
  for (const std::string& map : maps) {
    for (const char* extension : {".ply", ".ot"}) names.push_back(map_file(map, extension));
  }
  for (const ResultFile& file : kFiles) names.emplace_back(file.name);
  return names;
}

std::vector<OutputFile> result_files(const Result& result, const ResultFormats& formats,
                                     std::vector<std::string>& notes) {
  std::vector<OutputFile> files;
  for (const FusedMap& map : result.maps) add_map(files, map, result, notes);
  const Parts parts = parts_of(result, formats);
  for (const ResultFile& file : kFiles) files.push_back({file.name, file.bytes(parts)});
  return files;
}

}  // namespace kilter::app
