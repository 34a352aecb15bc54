// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/submap_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/octree_writer.h"
#include "kilter/report/cloud_pcd.h"
#include "kilter/report/cloud_ply.h"
#include "kilter/report/constraints_g2o.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPoses = "poses.tum";
constexpr const char* kElsewhere = "name another folder with -o";
constexpr std::string_view kFirstLine = "# t x y z qx qy qz qw: T_world_submap\n";
constexpr std::string_view kFirstLineOfGraph = "# kilter submaps: T_world_submap of each\n";

// "000012.ot": a name that this program gives where there are more submaps than 12.
bool is_ours(const std::string& name, std::size_t count) {
  constexpr std::array kFormats = {SubmapFormat::kOt, SubmapFormat::kBt, SubmapFormat::kPcd, SubmapFormat::kPly};
  std::size_t number = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), number);
  return status == std::errc() && number < count &&
         std::any_of(kFormats.begin(), kFormats.end(),
                     [&](SubmapFormat format) { return submap_file(number, format).filename() == name; });
}

bool is_read_as_submap(const std::string& name) { return has_octree_name(name) || cloud_format_of(name).has_value(); }

Expected<std::vector<std::string>> entries_of(const fs::path& folder) {
  if (!is_folder(folder)) return std::vector<std::string>();
  return list_folder(folder);
}

tl::unexpected<Error> refuse(const fs::path& path, std::string message, std::string hint) {
  return fail(ErrorCode::kUsage, std::move(message), shown(path), std::move(hint));
}

// Of how many submaps an earlier run of ours left the poses; nothing where there are none, or somebody else's.
Expected<std::optional<std::size_t>> count_earlier(const fs::path& folder) {
  if (!is_file(folder / kPoses)) return std::nullopt;
  const Expected<ByteBuffer> poses = read_file(folder / kPoses);
  if (!poses) return pass_up(poses.error());
  const std::string_view text = poses->view();
  if (!text.starts_with(kFirstLine)) return std::nullopt;
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) - 1;
}

// What would be read together with ours, or lost.
Expected<void> check_entries(const fs::path& folder, const std::vector<std::string>& names, bool replace) {
  const auto count = count_earlier(folder);
  if (!count) return pass_up(count.error());
  for (const std::string& name : names) {
    if (!name.starts_with("poses.")) continue;
    if (name != kPoses || !*count) return refuse(folder / name, "poses of somebody else", kElsewhere);
    if (!replace) return refuse(folder, "there are submaps already", "name another folder with -o, or --replace");
  }
  const auto submaps = entries_of(folder / "submaps");
  if (!submaps) return pass_up(submaps.error());
  std::size_t ours = 0;
  for (const std::string& name : *submaps) {
    if (*count && is_ours(name, **count) && is_file(folder / "submaps" / name)) {
      ++ours;
    } else if (is_read_as_submap(name)) {
      return refuse(folder / "submaps" / name, "a cloud of somebody else", kElsewhere);
    }
  }
  if (ours <= count->value_or(0)) return {};
  return refuse(folder / "submaps", "more clouds than poses: some are of somebody else", kElsewhere);
}

std::string stamp_text(std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (stamp_ns < 0) return fmt::format("{}", static_cast<double>(stamp_ns) * 1e-9);
  return fmt::format("{}.{:09}", stamp_ns / kSecond, stamp_ns % kSecond);
}

std::string poses_text(const std::vector<Submap>& submaps, const std::vector<std::int64_t>& stamps_ns) {
  std::string text(kFirstLine);
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    const Eigen::Vector3d& t = submaps[i].T_world_submap.translation_m();
    const Eigen::Quaterniond& q = submaps[i].T_world_submap.rotation();
    const std::string stamp = i < stamps_ns.size() ? stamp_text(stamps_ns[i]) : std::to_string(i);
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {}\n", stamp, t.x(), t.y(), t.z(), q.x(), q.y(),
                   q.z(), q.w());
  }
  return text;
}

}  // namespace

std::string extension_of(SubmapFormat format) {
  switch (format) {
    case SubmapFormat::kOt:
      return "ot";
    case SubmapFormat::kBt:
      return "bt";
    case SubmapFormat::kPcd:
      return "pcd";
    case SubmapFormat::kPly:
      return "ply";
  }
  return {};
}

fs::path submap_file(std::size_t number, SubmapFormat format) {
  return fs::path("submaps") / fmt::format("{:06}.{}", number, extension_of(format));
}

Expected<std::string> submap_bytes(const VoxelMap& map, SubmapFormat format, const OccupancyOptions& options) {
  if (format == SubmapFormat::kPcd) return cloud_pcd(map.voxels().centroids_m);
  if (format == SubmapFormat::kPly) return cloud_ply(map.voxels().centroids_m, {}, "submap");
  const double miss = options.probability_miss;
  const Expected<OccupancyCells> cells = cells_from_map(map, static_cast<float>(std::log(miss / (1.0 - miss))));
  if (!cells) return pass_up(cells.error());
  return octree_bytes(*cells, format == SubmapFormat::kOt ? OctreeFormat::kFull : OctreeFormat::kBinary);
}

Expected<void> check_robot_folder(const fs::path& folder, bool replace) {
  std::error_code error;
  for (const fs::path& path : {folder, folder / "submaps"}) {
    if (fs::is_symlink(fs::symlink_status(path, error))) {
      return refuse(path, "this is a symlink, and nothing is written through it", kElsewhere);
    }
    if (fs::exists(path, error) && !is_folder(path)) {
      return refuse(path, "expected a folder to write to, found something else", kElsewhere);
    }
  }
  const auto names = entries_of(folder);
  if (!names) return pass_up(names.error());
  if (is_folder(folder / "scans")) {
    return refuse(folder, "it holds scans/, and a robot has either scans or submaps", kElsewhere);
  }
  return check_entries(folder, *names, replace);
}

std::string pose_graph_text(const std::vector<SubmapSummary>& submaps) {
  return std::string(kFirstLineOfGraph) + submaps_g2o(submaps);
}

Expected<void> check_pose_graph(const fs::path& file, bool replace) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return {};
  const Expected<ByteBuffer> graph = read_file(file);
  if (!graph || !graph->view().starts_with(kFirstLineOfGraph)) {
    return refuse(file, "a file of somebody else, in the place of the pose graph", kElsewhere);
  }
  if (replace) return {};
  return refuse(file, "there is a pose graph already", "name another folder with -o, or --replace");
}

Expected<WaitingSubmaps> write_submaps(const StagingFolder& staging, const std::string& robot,
                                       const std::vector<Submap>& submaps, const std::vector<std::int64_t>& stamps_ns,
                                       SubmapFormat format, const OccupancyOptions& options) {
  WaitingSubmaps waiting;
  const auto write = [&](const fs::path& name, std::string_view bytes) {
    waiting.bytes += bytes.size();
    waiting.names.push_back(robot / name);
    return staging.write(robot / name, bytes);
  };
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    Expected<std::string> bytes = submap_bytes(submaps[i].map, format, options);
    if (!bytes) {
      bytes.error().where = printable(submaps[i].name);
      return pass_up(std::move(bytes.error()));
    }
    if (auto done = write(submap_file(i, format), *bytes); !done) return pass_up(done.error());
  }
  if (auto done = write(kPoses, poses_text(submaps, stamps_ns)); !done) return pass_up(done.error());
  return waiting;
}

Expected<std::vector<fs::path>> earlier_submaps(const fs::path& folder) {
  std::vector<fs::path> earlier;
  const auto count = count_earlier(folder);
  if (!count) return pass_up(count.error());
  if (!*count) return earlier;
  earlier.emplace_back(kPoses);
  const auto names = entries_of(folder / "submaps");
  if (!names) return pass_up(names.error());
  for (const std::string& name : *names) {
    if (is_ours(name, **count)) earlier.push_back(fs::path("submaps") / name);
  }
  return earlier;
}

}  // namespace kilter::app
