// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/count_mismatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "kilter/io/file.h"
#include "kilter/io/log_from_files.h"
#include "kilter/io/pose_list.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// The first file whose number is not its neighbour's plus one: most likely a scan between them is gone.
std::optional<std::size_t> find_gap(const std::vector<std::uint64_t>& numbers) {
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] <= numbers[i - 1]) return std::nullopt;
    if (numbers[i] - numbers[i - 1] > 1) return i;
  }
  return std::nullopt;
}

// Places, from 0, that the numbers between the first and the last leave out, where all were once there; one more than
// `most` at most.
std::vector<std::size_t> missing_places(const std::vector<std::uint64_t>& numbers, std::size_t most) {
  std::vector<std::size_t> places;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] <= numbers[i - 1]) return {};
    for (std::uint64_t n = numbers[i - 1] + 1; n < numbers[i] && places.size() <= most; ++n) {
      places.push_back(i + places.size());
    }
  }
  return places;
}

std::string lines_at(std::vector<std::size_t> places) {
  constexpr std::size_t kMostNamed = 5;
  const std::size_t count = places.size();
  for (std::size_t& place : places) ++place;
  places.resize(std::min(count, kMostNamed));
  return fmt::format("line{} {}{}", count == 1 ? "" : "s", fmt::join(places, ", "),
                     count > kMostNamed ? fmt::format(" and {} more", count - kMostNamed) : "");
}

// Where stamps leave out most, in front of pose `at`, if that is more than their usual steps.
struct StampGap {
  std::size_t at = 0;
  double gap_s = 0.0;
  double usual_s = 0.0;
};

std::optional<StampGap> largest_gap(const PoseTable& poses) {
  const auto stamps_ns = stamps_ns_of(poses);
  if (!stamps_ns || stamps_ns->size() < 4) return std::nullopt;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < stamps_ns->size(); ++i) {
    steps_s.push_back((static_cast<double>((*stamps_ns)[i]) - static_cast<double>((*stamps_ns)[i - 1])) * 1e-9);
  }
  const auto largest = std::max_element(steps_s.begin(), steps_s.end());
  StampGap gap{static_cast<std::size_t>(largest - steps_s.begin()) + 1, *largest, 0.0};
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  gap.usual_s = *middle;
  if (!(gap.usual_s > 0.0 && gap.gap_s > 1.5 * gap.usual_s)) return std::nullopt;
  return gap;
}

}  // namespace

tl::unexpected<Error> refuse_counts(const std::vector<std::string>& files, const PoseTable& poses,
                                    const fs::path& pose_file, const fs::path& clouds) {
  const std::size_t count = poses.T_world_cloud.size();
  const std::string name = shown(pose_file.filename());
  const auto file = [&](std::size_t i) { return printable(files[i], 80); };
  std::string found =
      fmt::format("{} poses in {}, but {} files in {}; ", count, name, files.size(), shown(clouds.filename()));
  std::string hint = "one pose per file, in the order of the files' names";
  if (count < files.size()) {
    found += fmt::format("{} is the first without a pose", file(count));
    if (const auto gap = largest_gap(poses)) {
      found += fmt::format(
          ", if they begin together; the stamps of the poses step by {:.3g} s, but by {:.3g} s from {} to {}",
          gap->usual_s, gap->gap_s, lines_at({gap->at - 1}), gap->at + 1);
      if (std::llround(gap->gap_s / gap->usual_s) == static_cast<long long>(files.size() - count) + 1) {
        hint +=
            fmt::format(": if poses are missing there, move {} away{}", file(gap->at),
                        files.size() - count == 1 ? std::string()
                                                  : fmt::format(", and the {} behind it", files.size() - count - 1));
      }
    }
    return fail(ErrorCode::kCountMismatch, found, shown(pose_file), hint);
  }
  const auto numbers = numbers_of_files(files);
  const auto gap = numbers ? find_gap(*numbers) : std::nullopt;
  if (!gap) {
    found += fmt::format("pose {} (the first being 0) is the first without a file", files.size());
    return fail(ErrorCode::kCountMismatch, found, shown(pose_file), hint);
  }
  found += fmt::format("the first missing one lies between {} and {}", file(*gap - 1), file(*gap));
  const std::vector<std::size_t> missing = missing_places(*numbers, count - files.size());
  if (missing.size() == count - files.size()) {
    hint += fmt::format(": take out {} of {}, headings and comments not counted", lines_at(missing), name);
  }
  return fail(ErrorCode::kCountMismatch, found, shown(pose_file), hint);
}

}  // namespace kilter
