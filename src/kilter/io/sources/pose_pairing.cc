// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/pose_pairing.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "kilter/io/count_mismatch.h"
#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/stamped_trajectory.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kMaxGap_ns = 250 * kMillisecond_ns;
constexpr std::int64_t kSlack_ns = 5 * kMillisecond_ns;

// Everything that the ways of pairing share.
struct Pairing {
  RobotLog& log;
  const fs::path& folder;
  const std::vector<std::string>& names;
  const PoseList& poses;
  const fs::path& pose_file;
};

void keep(const Pairing& pairing, std::vector<fs::path>& paths, const std::string& name, const Pose3& pose) {
  pairing.log.T_world_cloud.push_back(pose);
  paths.push_back(pairing.folder / name);
}

// A stamp for each name, or nothing if one has none.
std::optional<std::vector<StampText>> stamps_of(const std::vector<std::string>& names) {
  std::vector<StampText> stamps;
  for (const std::string& name : names) {
    const std::optional<StampText> stamp = stamp_of_file(name);
    if (!stamp) return std::nullopt;
    stamps.push_back(*stamp);
  }
  return stamps;
}

// The numbers that names count by.
std::optional<std::vector<StampText>> counts_of(const std::vector<std::string>& names) {
  const auto numbers = numbers_of_files(names);
  if (!numbers) return std::nullopt;
  std::vector<StampText> counts;
  for (const std::uint64_t number : *numbers) {
    if (number > static_cast<std::uint64_t>(INT64_MAX)) return std::nullopt;
    counts.push_back({static_cast<std::int64_t>(number), 0, false});
  }
  return counts;
}

void pair_in_order(const Pairing& pairing) {
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < pairing.names.size(); ++i) {
    keep(pairing, paths, pairing.names[i], pairing.poses.T_world_cloud[i]);
  }
  take_stamps(pairing.log, pairing.poses);
  read_from_files(pairing.log, std::move(paths));
}

// A table may name clouds with or without their extension.
const std::size_t* find_row(const std::map<std::string, std::size_t>& rows, const std::string& name) {
  auto found = rows.find(name);
  if (found == rows.end()) found = rows.find(name.substr(0, name.rfind('.')));
  return found == rows.end() ? nullptr : &found->second;
}

Expected<void> pair_by_file(const Pairing& pairing, std::vector<std::string>& notes) {
  std::map<std::string, std::size_t> rows;
  for (std::size_t i = 0; i < pairing.poses.files.size(); ++i) {
    if (rows.emplace(pairing.poses.files[i], i).second) continue;
    return fail(ErrorCode::kParse, fmt::format("two poses name one cloud, {}", printable(pairing.poses.files[i], 80)),
                shown(pairing.pose_file));
  }
  const auto stamps_ns = stamps_ns_of(pairing.poses);
  std::vector<fs::path> paths;
  for (const std::string& name : pairing.names) {
    const std::size_t* row = find_row(rows, name);
    if (row == nullptr) continue;
    keep(pairing, paths, name, pairing.poses.T_world_cloud[*row]);
    if (stamps_ns) pairing.log.stamps_ns.push_back((*stamps_ns)[*row]);
  }
  if (stamps_ns) pairing.log.stamp_unit = symbol_of(stamp_unit_of(pairing.poses));
  if (paths.empty()) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("it names {}, but the clouds are {}", some_of(pairing.poses.files), some_of(pairing.names)),
                shown(pairing.pose_file), "the column of file names decides which cloud has which pose");
  }
  if (paths.size() < pairing.names.size()) notes.push_back(matched_note(pairing.log, "file name"));
  read_from_files(pairing.log, std::move(paths));
  return {};
}

// Stamps of both sides, each in its own unit.
struct StampSides {
  std::vector<StampText> clouds;
  StampUnit cloud_unit = StampUnit::kSeconds;
  StampUnit pose_unit = StampUnit::kSeconds;
};

tl::unexpected<Error> refuse_stamps(const Pairing& pairing, const StampSides& sides) {
  return fail(ErrorCode::kCountMismatch,
              fmt::format("no cloud has a pose at its time: names of {} clouds go from {}; stamps of {} poses from {}",
                          pairing.names.size(), range_of(sides.clouds, sides.cloud_unit), pairing.poses.stamps.size(),
                          range_of(pairing.poses.stamps, sides.pose_unit)),
              shown(pairing.pose_file),
              "units are guessed by magnitude; if they are right, the clocks differ: shift one side, or give as many "
              "poses as clouds under names that are mere numbers");
}

struct TimedCloud {
  std::int64_t stamp_ns = 0;
  std::size_t index = 0;
};

std::vector<TimedCloud> in_order_of_time(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<TimedCloud> clouds;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) clouds.push_back({stamps_ns[i], i});
  std::stable_sort(clouds.begin(), clouds.end(),
                   [](const TimedCloud& a, const TimedCloud& b) { return a.stamp_ns < b.stamp_ns; });
  return clouds;
}

// \param exactly  stamps must be equal: both sides only count
// \return whether any cloud found its pose
bool match_stamps(const Pairing& pairing, const StampSides& sides, bool exactly, std::vector<std::string>& notes) {
  const auto cloud_ns = to_nanoseconds(sides.clouds, sides.cloud_unit);
  const auto pose_ns = to_nanoseconds(pairing.poses.stamps, sides.pose_unit);
  if (!cloud_ns || !pose_ns) return false;
  std::vector<StampedPose> stamped;
  for (std::size_t i = 0; i < pose_ns->size(); ++i) {
    stamped.push_back({(*pose_ns)[i], pairing.poses.T_world_cloud[i]});
  }
  const StampedTrajectory trajectory(std::move(stamped));
  std::vector<fs::path> paths;
  for (const TimedCloud& cloud : in_order_of_time(*cloud_ns)) {
    const auto pose = trajectory.at(cloud.stamp_ns, exactly ? 0 : kMaxGap_ns, exactly ? 0 : kSlack_ns);
    if (!pose) continue;
    keep(pairing, paths, pairing.names[cloud.index], *pose);
    pairing.log.stamps_ns.push_back(cloud.stamp_ns);
  }
  pairing.log.stamp_unit = symbol_of(sides.cloud_unit);
  pairing.log.poses_are_a_trajectory = !exactly;
  if (paths.empty()) return false;
  read_from_files(pairing.log, std::move(paths));
  if (const std::size_t twice = pose_ns->size() - trajectory.poses().size(); twice > 0) {
    notes.push_back(
        fmt::format("robot {}: {} of {} poses have the stamp of one before and are left out; stamps that were "
                    "written with too few digits look so",
                    pairing.log.name, twice, pose_ns->size()));
  }
  return true;
}

StampSides sides_of(const Pairing& pairing, std::vector<StampText> clouds) {
  StampSides sides;
  sides.cloud_unit = guess_unit(clouds);
  sides.pose_unit = stamp_unit_of(pairing.poses);
  sides.clouds = std::move(clouds);
  return sides;
}

Expected<void> pair_by_vertex(const Pairing& pairing, std::vector<std::string>& notes) {
  std::vector<NumberedPose> vertices;
  for (std::size_t i = 0; i < pairing.poses.ids.size(); ++i) {
    vertices.push_back({pairing.poses.ids[i], pairing.poses.T_world_cloud[i]});
  }
  return pair_by_number(pairing.log, pairing.folder, pairing.names, vertices, {}, {pairing.pose_file, "vertex"}, notes);
}

// Whether numbers of as many clouds and vertices are for the most part the same and not all: a cloud is missing in one
// place and a vertex in another, and in order all between would go with the wrong one.
bool are_numbered_alike(const Pairing& pairing) {
  const auto numbers = numbers_of_files(pairing.names);
  if (!numbers || pairing.poses.ids.empty()) return false;
  std::size_t met = 0;
  for (const std::uint64_t number : *numbers) {
    met += std::binary_search(pairing.poses.ids.begin(), pairing.poses.ids.end(), number) ? 1 : 0;
  }
  return met < numbers->size() && 2 * met > numbers->size();
}

// Counts differ, and the names are no stamps: numbers that both sides have.
Expected<void> pair_by_count(const Pairing& pairing, std::vector<std::string>& notes) {
  const std::optional<std::vector<StampText>> numbers = counts_of(pairing.names);
  if (numbers && !pairing.poses.ids.empty()) return pair_by_vertex(pairing, notes);
  if (numbers && !pairing.poses.stamps.empty()) {
    const StampSides sides = sides_of(pairing, *numbers);
    const bool both_count = std::all_of(pairing.poses.stamps.begin(), pairing.poses.stamps.end(),
                                        [](const StampText& stamp) { return stamp.billionths == 0; });
    if (both_count && match_stamps(pairing, sides, true, notes)) {
      notes.push_back(matched_note(pairing.log, "number, which the poses have in place of stamps"));
      return {};
    }
  }
  return refuse_counts(pairing.names, pairing.poses, pairing.pose_file, pairing.folder);
}

}  // namespace

Expected<void> pair_clouds(RobotLog& log, const fs::path& folder, const std::vector<std::string>& names,
                           const PoseList& poses, const fs::path& pose_file, std::vector<std::string>& notes) {
  const Pairing pairing{log, folder, names, poses, pose_file};
  log.clouds_found = names.size();
  log.poses_found = poses.T_world_cloud.size();
  if (!poses.files.empty()) return pair_by_file(pairing, notes);
  const bool as_many = names.size() == poses.T_world_cloud.size();
  const std::optional<std::vector<StampText>> numbers = stamps_of(names);
  if (numbers && look_like_stamps(*numbers) && !poses.stamps.empty()) {
    const StampSides sides = sides_of(pairing, *numbers);
    if (match_stamps(pairing, sides, false, notes)) {
      notes.push_back(matched_note(log, fmt::format("stamp (names in {}, poses in {})", symbol_of(sides.cloud_unit),
                                                    symbol_of(sides.pose_unit))));
      return {};
    }
    if (!as_many) return refuse_stamps(pairing, sides);
    notes.push_back(
        fmt::format("robot {}: names of clouds go from {}, stamps of {} from {}: no two meet, so clouds and poses are "
                    "taken in order",
                    log.name, range_of(sides.clouds, sides.cloud_unit), shown(pose_file.filename()),
                    range_of(poses.stamps, sides.pose_unit)));
  }
  if (!as_many) return pair_by_count(pairing, notes);
  if (are_numbered_alike(pairing)) return pair_by_vertex(pairing, notes);
  pair_in_order(pairing);
  return {};
}

}  // namespace kilter
