// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/cloud_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "kilter/base/contract.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/sources/foreign_file.h"
#include "kilter/io/stamp_text.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

const NumberedPose* find_pose(std::span<const NumberedPose> poses, std::uint64_t id) {
  const auto found = std::lower_bound(poses.begin(), poses.end(), id,
                                      [](const NumberedPose& pose, std::uint64_t wanted) { return pose.id < wanted; });
  return found == poses.end() || found->id != id ? nullptr : &*found;
}

std::optional<std::vector<StampText>> parse_stamp_lines(std::string_view bytes) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::vector<StampText> stamps;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = *line;
    const std::string_view word = take_word(rest);
    if (word.empty()) continue;
    const std::optional<StampText> stamp = parse_stamp_text(word);
    if (!stamp || !take_word(rest).empty()) return std::nullopt;
    stamps.push_back(*stamp);
  }
  return stamps;
}

tl::unexpected<Error> refuse_name(const fs::path& cloud, const PoseOrigin& origin) {
  return fail(ErrorCode::kUnsupported, "expected a number as the cloud's name, found another name", shown(cloud),
              fmt::format("000012{} belongs to {} 12 of {}", cloud.extension().string(), origin.id_word,
                          shown(origin.file.filename())));
}

}  // namespace

Expected<std::vector<std::string>> list_clouds_of(const fs::path& folder) {
  const auto names = list_folder(folder);
  if (!names) return pass_up(names.error());
  std::vector<std::string> clouds;
  for (const std::string& name : *names) {
    const std::optional<CloudFormat> format = cloud_format_of(name);
    if (name.starts_with('.') || !format) continue;
    if (auto ok = expect_file(folder / name); !ok) return pass_up(ok.error());
    if (!clouds.empty() && *format != *cloud_format_of(clouds.front())) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("one folder holds one format, found {} and {}", printable(clouds.front(), 80),
                              printable(name, 80)),
                  shown(folder), "move the files of one of them away");
    }
    clouds.push_back(name);
  }
  if (!clouds.empty()) return clouds;
  if (const ForeignFormat* format = find_foreign(*names)) {
    return fail(ErrorCode::kUnsupported, fmt::format("no cloud in it that kilter reads, but {}", format->what),
                shown(folder), std::string(format->way_out));
  }
  return fail(ErrorCode::kEmptyInput, "no cloud in it", shown(folder));
}

Expected<void> pair_by_number(RobotLog& log, const fs::path& folder, std::span<const std::string> names,
                              std::span<const NumberedPose> poses, const Stamps& stamps, const PoseOrigin& origin,
                              std::vector<std::string>& notes) {
  KILTER_EXPECTS(!names.empty() && !poses.empty());
  KILTER_EXPECTS(stamps.ns.empty() || stamps.ns.size() == poses.size());
  std::vector<std::string> sorted(names.begin(), names.end());
  sort_by_number(sorted);
  std::vector<fs::path> paths;
  const auto numbers = numbers_of_files(sorted);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const std::string& name = sorted[i];
    const std::optional<std::uint64_t> id = numbers ? (*numbers)[i] : number_of_file(name);
    if (!id) return refuse_name(folder / name, origin);
    const NumberedPose* pose = find_pose(poses, *id);
    if (pose == nullptr) continue;
    log.T_world_cloud.push_back(pose->T_world_cloud);
    if (!stamps.ns.empty()) log.stamps_ns.push_back(stamps.ns[static_cast<std::size_t>(pose - poses.data())]);
    paths.push_back(folder / name);
  }
  log.stamp_unit = stamps.unit;
  log.clouds_found = sorted.size();
  log.poses_found = poses.size();
  if (paths.empty()) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("none of {} clouds, {} to {}, has a {} of its number; those go from {} to {}",
                            sorted.size(), printable(sorted.front(), 80), printable(sorted.back(), 80), origin.id_word,
                            poses.front().id, poses.back().id),
                shown(origin.file));
  }
  if (paths.size() < sorted.size()) notes.push_back(matched_note(log, "number"));
  read_from_files(log, std::move(paths));
  return {};
}

void sort_by_number(std::vector<std::string>& names) {
  const auto numbers = numbers_of_files(names);
  if (!numbers) return;
  std::vector<std::pair<std::uint64_t, std::string>> numbered;
  for (std::size_t i = 0; i < names.size(); ++i) numbered.emplace_back((*numbers)[i], std::move(names[i]));
  std::stable_sort(numbered.begin(), numbered.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(numbered.begin(), numbered.end(), names.begin(), [](auto& one) { return std::move(one.second); });
}

std::vector<NumberedPose> number_from_zero(std::span<const Pose3> poses) {
  std::vector<NumberedPose> numbered;
  numbered.reserve(poses.size());
  for (const Pose3& pose : poses) numbered.push_back({numbered.size(), pose});
  return numbered;
}

Stamps read_stamps_if_any(const fs::path& file, std::size_t count, const std::string& robot,
                          std::vector<std::string>& notes) {
  if (!is_file(file)) return {};
  const auto bytes = read_file(file, kMaxPoseFileBytes);
  if (!bytes) return {};
  const std::optional<std::vector<StampText>> stamps = parse_stamp_lines(bytes->view());
  if (!stamps || stamps->size() != count) {
    notes.push_back(fmt::format("robot {}: stamps are not known: {} is not a list of {} of them", robot,
                                shown(file.filename()), count));
    return {};
  }
  const StampUnit unit = guess_unit(*stamps);
  auto stamps_ns = to_nanoseconds(*stamps, unit);
  return stamps_ns ? Stamps{*std::move(stamps_ns), symbol_of(unit)} : Stamps{};
}

Expected<void> check_names(std::span<const std::string> clouds, const PoseTable& poses, const fs::path& pose_file) {
  for (std::size_t i = 0; i < poses.files.size(); ++i) {
    const std::string& named = poses.files[i];
    if (named == clouds[i] || named == clouds[i].substr(0, clouds[i].rfind('.'))) continue;
    return fail(ErrorCode::kCountMismatch,
                fmt::format("pose {} (the first being 0) names {}, but cloud {} is {}", i, printable(named, 80), i,
                            printable(clouds[i], 80)),
                shown(pose_file),
                "order its lines as the clouds' names sort bytewise, or leave the column of names out");
  }
  return {};
}

void take_stamps(RobotLog& log, const PoseTable& poses) {
  auto stamps_ns = stamps_ns_of(poses);
  if (!stamps_ns) return;
  log.stamps_ns = *std::move(stamps_ns);
  log.stamp_unit = symbol_of(stamp_unit_of(poses));
}

std::string matched_note(const RobotLog& log, std::string_view by) {
  const std::size_t left_out = log.clouds_found - log.T_world_cloud.size();
  const std::string rest = left_out == 0   ? ""
                           : left_out == 1 ? "; the other one is left out"
                                           : fmt::format("; the other {} are left out", left_out);
  return fmt::format("robot {}: poses matched {} of {} clouds by {}{}", log.name, log.T_world_cloud.size(),
                     log.clouds_found, by, rest);
}

void note_coarse_poses(const RobotLog& log, std::string_view file_name, std::vector<std::string>& notes) {
  constexpr double kCoarse_m = 1000.0;  // the sixth digit of 1234.56 is a centimetre
  double farthest_m = 0.0;
  for (const Pose3& pose : log.T_world_cloud) {
    farthest_m = std::max(farthest_m, pose.translation_m().cwiseAbs().maxCoeff());
  }
  if (farthest_m < kCoarse_m) return;
  notes.push_back(fmt::format(
      "robot {}: positions reach {:.0f} m from the origin, where the six digits of {} are {} apart; use another pose "
      "source by --poses if there is a finer one",
      log.name, farthest_m, file_name, farthest_m < 10.0 * kCoarse_m ? "1 cm" : "10 cm or more"));
}

}  // namespace kilter
