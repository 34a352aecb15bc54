// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Measures of a pair that kilter's verdicts do not use, so that what they would add can be told.
//
//     kilter_other_evidence MISSION
//
// builds the submaps of MISSION as `check` does with its defaults, and of each two more from every other scan. Then
// each line of standard input
//
//     SOURCE TARGET x y z qx qy qz qw x y z qx qy qz qw
//
// (numbers of submaps; T_target_source of the map, and as registered) is answered by a line of JSON. A line of a
// submap's number alone is answered by what its two halves say of each other.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <deque>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/io/mission.h"
#include "kilter/matching/same_side.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/report/json_writer.h"

namespace {

using namespace kilter;

constexpr std::array<double, 3> kScales_m = {0.2, 0.5, 1.0};
constexpr std::array<double, 2> kCells_m = {1.0, 2.0};
constexpr std::size_t kFacings = 6;
constexpr std::size_t kFewestOfFacing = 100;  // residuals
constexpr std::size_t kFewestOfCell = 12;

// A map and where it lies.
struct Piece {
  Pose3 T_world_piece;
  std::optional<SearchableMap> map;
};

struct Mean {
  double sum = 0.0;
  std::size_t count = 0;

  void add(double value) {
    sum += value;
    ++count;
  }
  [[nodiscard]] double mean() const { return count == 0 ? 0.0 : sum / static_cast<double>(count); }
};

// Which of the six ways along the axes a normal is nearest to.
std::size_t facing_of(const Eigen::Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::size_t>(2 * axis + (normal[axis] < 0.0 ? 1 : 0));
}

// Everything that is summed over the voxels of a pair, both ways, at one pose.
class Measures {
 public:
  // Voxels of `from` that `onto` could have seen: those in a cell that it knows, free or occupied.
  void add(const VoxelMap& from, const VoxelMap& onto, const Pose3& T_onto_from, const Pose3& T_frame_onto,
           const std::vector<NearestVoxel>& near) {
    const bool oriented = from.has_free_space() && onto.has_free_space();
    const Eigen::Matrix3d R = T_onto_from.rotation_matrix();
    for (std::size_t i = 0; i < from.voxels().size(); ++i) {
      const Eigen::Vector3d at_m = T_onto_from * Eigen::Vector3d(from.voxels().centroids_m[i].cast<double>());
      if (onto.state(voxel_at(at_m, onto.resolution_m())) == CellState::kUnknown) continue;
      const bool found = near[i].voxel != kNoVoxel;
      const double distance_m = found ? near[i].distance_m : kScales_m.back();
      for (std::size_t k = 0; k < kScales_m.size(); ++k) distances_[k].add(std::min(distance_m, kScales_m[k]));
      if (!found) continue;
      const Eigen::Vector3d normal = onto.voxels().normals[near[i].voxel].cast<double>();
      if (normal.isZero() || !normals_agree(R * from.voxels().normals[i].cast<double>(), normal, oriented)) continue;
      const Eigen::Vector3d there_m = onto.voxels().centroids_m[near[i].voxel].cast<double>();
      add_residual(normal.dot(at_m - there_m), distance_m, T_frame_onto.rotation() * normal, T_frame_onto * there_m);
    }
  }

  void write(JsonWriter& json) const {
    for (std::size_t k = 0; k < kScales_m.size(); ++k) {
      json.field(fmt::format("distance {}", kScales_m[k]), distances_[k].mean());
      json.field(fmt::format("residual {}", kScales_m[k]), std::sqrt(squares_[k].mean()));
      double worst_m = 0.0;
      for (const Mean& facing : facings_[k]) {
        if (facing.count >= kFewestOfFacing) worst_m = std::max(worst_m, std::abs(facing.mean()));
      }
      json.field(fmt::format("facing {}", kScales_m[k]), worst_m);
    }
    for (std::size_t c = 0; c < kCells_m.size(); ++c) {
      Mean squares;
      for (const auto& [key, cell] : cells_[c]) {
        if (cell.count >= kFewestOfCell) squares.add(cell.mean() * cell.mean());
      }
      json.field(fmt::format("cells {}", kCells_m[c]), std::sqrt(squares.mean()));
    }
  }

 private:
  using CellKey = std::array<int, 4>;

  void add_residual(double residual_m, double distance_m, const Eigen::Vector3d& normal, const Eigen::Vector3d& at_m) {
    const std::size_t facing = facing_of(normal);
    for (std::size_t k = 0; k < kScales_m.size(); ++k) {
      if (distance_m > kScales_m[k]) continue;
      squares_[k].add(residual_m * residual_m);
      facings_[k][facing].add(residual_m);
    }
    if (distance_m > kScales_m[1]) return;
    for (std::size_t c = 0; c < kCells_m.size(); ++c) {
      const Eigen::Vector3i cell = (at_m / kCells_m[c]).array().floor().matrix().cast<int>();
      cells_[c][{cell.x(), cell.y(), cell.z(), static_cast<int>(facing)}].add(residual_m);
    }
  }

  std::array<Mean, kScales_m.size()> distances_;
  std::array<Mean, kScales_m.size()> squares_;
  std::array<std::array<Mean, kFacings>, kScales_m.size()> facings_;
  std::array<std::map<CellKey, Mean>, kCells_m.size()> cells_;
};

Measures measure(const SearchableMap& source, const SearchableMap& target, const Pose3& T_target_source) {
  const NearestBothWays near =
      nearest_both_ways(source.by_centroid(), target.by_centroid(), T_target_source, kScales_m.back());
  const Pose3 T_source_target = T_target_source.inverse();
  Measures measures;
  measures.add(source.map(), target.map(), T_target_source, Pose3(), near.forward);
  measures.add(target.map(), source.map(), T_source_target, T_target_source, near.backward);
  return measures;
}

// Every second cell of two blocks (1.6 m), as on a chessboard.
VoxelMap chessboard(const VoxelMap& map, int colour) {
  std::vector<VoxelBlock> blocks;
  SurfaceVoxels voxels;
  voxels.cell_m = map.voxels().cell_m;
  const SurfaceVoxels& all = map.voxels();
  for (VoxelBlock block : map.blocks()) {
    const Eigen::Vector3i at = block_of_key(block.key);
    if ((((at.x() >> 1) + (at.y() >> 1) + (at.z() >> 1)) & 1) != colour) {
      if (block.free == decltype(block.free){}) continue;
      block.occupied = {};
      block.first_voxel = static_cast<std::uint32_t>(voxels.size());
      block.voxel_count = 0;
      blocks.push_back(block);
      continue;
    }
    const std::size_t first = block.first_voxel;
    block.first_voxel = static_cast<std::uint32_t>(voxels.size());
    for (std::size_t i = first; i < first + block.voxel_count; ++i) {
      voxels.centroids_m.push_back(all.centroids_m[i]);
      voxels.normals.push_back(all.normals[i]);
      voxels.planarity.push_back(all.planarity[i]);
      voxels.log_odds.push_back(all.log_odds[i]);
      voxels.seen_at.push_back(all.seen_at[i]);
      voxels.hits.push_back(all.hits[i]);
    }
    blocks.push_back(block);
  }
  return {map.resolution_m(), map.has_free_space(), std::move(blocks), std::move(voxels)};
}

// Registered on one half of the cells, judged on the other, both ways round.
void write_split_cells(const std::array<std::optional<SearchableMap>, 2>& halves, const SearchableMap& target,
                       const Pose3& T_target_source, const CheckOptions& options, JsonWriter& json) {
  Mean displacement;
  for (std::size_t colour = 0; colour < 2; ++colour) {
    const SearchableMap& fitted = *halves[colour];
    const SearchableMap& judged = *halves[1 - colour];
    if (fitted.map().voxels().size() == 0 || judged.map().voxels().size() == 0) continue;
    const RegistrationResult found = align_submaps(fitted.by_centroid(), target.by_centroid(), T_target_source,
                                                   options.registration, RegistrationPrior{});
    if (!found.converged()) continue;
    const Pose3 moved = found.T_target_source * T_target_source.inverse();
    displacement.add((moved * found.centre_target_m - found.centre_target_m).norm());
    json.key(fmt::format("judged {}", colour)).open_object(JsonWriter::Layout::kCompact);
    measure(judged, target, found.T_target_source).write(json);
    json.close();
  }
  if (displacement.count > 0) json.field("split displacement", displacement.mean());
}

// The log of every second scan of each range, from its first or its second scan on.
RobotLog every_other(const RobotLog& log, const std::vector<ScanRange>& ranges, std::size_t from,
                     std::vector<ScanRange>& cuts) {
  std::vector<std::size_t> scans;
  RobotLog half = log;
  half.T_world_cloud.clear();
  for (const ScanRange& range : ranges) {
    const std::size_t first = scans.size();
    for (std::size_t scan = range.first + (range.last > range.first ? from : 0); scan <= range.last; scan += 2) {
      scans.push_back(scan);
      half.T_world_cloud.push_back(log.T_world_cloud[scan]);
    }
    cuts.push_back({first, scans.size() - 1});
  }
  half.stamps_ns.clear();
  half.read_cloud = [read = log.read_cloud, scans](std::size_t i) { return read(scans[i]); };
  return half;
}

struct Pieces {
  std::deque<Piece> whole;
  std::array<std::deque<Piece>, 2> halves;  // of each submap's scans
};

Expected<void> build(const RobotLog& log, const std::optional<std::vector<ScanRange>>& cuts,
                     const CheckOptions& options, std::deque<Piece>& pieces, std::vector<ScanRange>* ranges) {
  Expected<std::vector<Submap>> submaps = build_submaps(log, 0, options.submap, {}, cuts);
  if (!submaps) return pass_up(submaps.error());
  for (Submap& submap : *submaps) {
    if (ranges != nullptr) ranges->push_back(*submap.scans);
    Piece& piece = pieces.emplace_back();
    piece.T_world_piece = submap.T_world_submap;
    piece.map.emplace(std::move(submap.map), search_setup(options));
  }
  return {};
}

Expected<Pieces> pieces_of(const Mission& mission, const CheckOptions& options) {
  Pieces pieces;
  for (const RobotLog& log : mission.robots) {
    std::vector<ScanRange> ranges;
    if (auto done = build(log, {}, options, pieces.whole, &ranges); !done) return pass_up(done.error());
    for (std::size_t half = 0; half < 2; ++half) {
      std::vector<ScanRange> cuts;
      const RobotLog thinned = every_other(log, ranges, half, cuts);
      if (auto done = build(thinned, cuts, options, pieces.halves[half], nullptr); !done) return pass_up(done.error());
    }
  }
  return pieces;
}

std::optional<Pose3> pose_from(std::istream& words) {
  std::array<double, 7> pose{};
  for (double& number : pose) words >> number;
  if (!words) return std::nullopt;
  return Pose3(Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]), Eigen::Vector3d(pose[0], pose[1], pose[2]));
}

// What two submaps say of each other at one pose.
void write_at(std::string_view where, const SearchableMap& source, const SearchableMap& target,
              const Pose3& T_target_source, JsonWriter& json) {
  json.key(where).open_object(JsonWriter::Layout::kCompact);
  measure(source, target, T_target_source).write(json);
  json.close();
}

std::string of_halves(const Pieces& pieces, std::size_t submap) {
  const Piece& first = pieces.halves[0][submap];
  const Piece& second = pieces.halves[1][submap];
  JsonWriter json;
  json.open_object(JsonWriter::Layout::kCompact);
  measure(*second.map, *first.map, first.T_world_piece.inverse() * second.T_world_piece).write(json);
  return json.close().take();
}

int answer(const Pieces& pieces, const CheckOptions& options) {
  std::vector<std::array<std::optional<SearchableMap>, 2>> boards(pieces.whole.size());
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::size_t source = 0;
    std::size_t target = 0;
    if (!(words >> source) || source >= pieces.whole.size()) return 2;
    if (!(words >> target)) {
      std::cout << of_halves(pieces, source);
      continue;
    }
    const std::optional<Pose3> given = pose_from(words);
    if (!given || target >= pieces.whole.size()) return 2;
    const SearchableMap& source_map = *pieces.whole[source].map;
    const SearchableMap& target_map = *pieces.whole[target].map;
    JsonWriter json;
    json.open_object(JsonWriter::Layout::kCompact);
    write_at("map", source_map, target_map, *given, json);
    if (const std::optional<Pose3> registered = pose_from(words)) {
      write_at("registered", source_map, target_map, *registered, json);
    }
    for (std::size_t colour = 0; colour < 2; ++colour) {
      std::optional<SearchableMap>& board = boards[source][colour];
      if (!board) board.emplace(chessboard(source_map.map(), static_cast<int>(colour)), search_setup(options));
    }
    write_split_cells(boards[source], target_map, *given, options, json);
    std::cout << json.close().take();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: kilter_other_evidence MISSION < PAIRS\n");
    return 2;
  }
  const CheckOptions options = resolved({});
  const Expected<Mission> mission = open_mission({argv[1]}, {});
  if (!mission) {
    fmt::print(stderr, "{}: {}\n", mission.error().where, mission.error().message);
    return 3;
  }
  const Expected<Pieces> pieces = pieces_of(*mission, options);
  if (!pieces) {
    fmt::print(stderr, "{}: {}\n", pieces.error().where, pieces.error().message);
    return 3;
  }
  return answer(*pieces, options);
}
