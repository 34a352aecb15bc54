// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/submap_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <system_error>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/octree_writer.h"
#include "kilter/report/cloud_pcd.h"
#include "kilter/report/cloud_ply.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPoses = "poses.tum";
constexpr std::size_t kDigits = 6;

// "000012.ot": a name that this program gives.
bool is_ours(const std::string& name) {
  constexpr std::array kFormats = {SubmapFormat::kOt, SubmapFormat::kBt, SubmapFormat::kPcd, SubmapFormat::kPly};
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || dot < kDigits) return false;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(dot), is_digit) &&
         std::any_of(kFormats.begin(), kFormats.end(),
                     [&](SubmapFormat format) { return name.substr(dot + 1) == extension_of(format); });
}

bool is_read_as_submap(const std::string& name) { return has_octree_name(name) || cloud_format_of(name).has_value(); }

Expected<std::vector<std::string>> entries_of(const fs::path& folder) {
  if (!is_folder(folder)) return std::vector<std::string>();
  return list_folder(folder);
}

tl::unexpected<Error> refuse(const fs::path& path, std::string message, std::string hint) {
  return fail(ErrorCode::kUsage, std::move(message), shown(path), std::move(hint));
}

// What would be read together with ours, or lost.
Expected<void> check_entries(const fs::path& folder, const std::vector<std::string>& names, bool replace) {
  const auto submaps = entries_of(folder / "submaps");
  if (!submaps) return pass_up(submaps.error());
  for (const std::string& name : names) {
    if (!name.starts_with("poses.")) continue;
    if (name != kPoses) return refuse(folder / name, "poses of somebody else", "name another folder with -o");
    if (!replace) return refuse(folder, "there are submaps already", "name another folder with -o, or --replace");
  }
  for (const std::string& name : *submaps) {
    if (is_ours(name) && !replace) {
      return refuse(folder, "there are submaps already", "name another folder with -o, or --replace");
    }
    if (!is_ours(name) && is_read_as_submap(name)) {
      return refuse(folder / "submaps" / name, "a cloud of somebody else", "name another folder with -o");
    }
  }
  return {};
}

Expected<void> remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (!error) return {};
  return fail(ErrorCode::kIo, fmt::format("cannot be removed: {}", error.message()), shown(path));
}

std::string stamp_text(std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (stamp_ns < 0) return fmt::format("{}", static_cast<double>(stamp_ns) * 1e-9);
  return fmt::format("{}.{:09}", stamp_ns / kSecond, stamp_ns % kSecond);
}

std::string poses_text(const std::vector<Submap>& submaps, const std::vector<std::int64_t>& stamps_ns) {
  std::string text = "# t x y z qx qy qz qw: T_world_submap\n";
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
      return refuse(path, "this is a symlink, and nothing is written through it", "name another folder with -o");
    }
    if (fs::exists(path, error) && !is_folder(path)) {
      return refuse(path, "expected a folder to write to, found something else", "name another folder with -o");
    }
  }
  const auto names = entries_of(folder);
  if (!names) return pass_up(names.error());
  if (is_folder(folder / "scans")) {
    return refuse(folder, "it holds scans/, and a robot has either scans or submaps", "name another folder with -o");
  }
  return check_entries(folder, *names, replace);
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

Expected<void> remove_earlier_submaps(const fs::path& folder) {
  if (auto done = remove_file(folder / kPoses); !done) return done;
  const auto names = entries_of(folder / "submaps");
  if (!names) return pass_up(names.error());
  for (const std::string& name : *names) {
    if (!is_ours(name)) continue;
    if (auto done = remove_file(folder / "submaps" / name); !done) return done;
  }
  return {};
}

}  // namespace kilter::app
