// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/stamp_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kilter/base/contract.h"
#include "kilter/io/number_text.h"

namespace kilter {
namespace {

constexpr std::array kUnits = {StampUnit::kSeconds, StampUnit::kMilliseconds, StampUnit::kMicroseconds,
                               StampUnit::kNanoseconds};
constexpr std::int64_t kBillion = 1'000'000'000;

std::int64_t units_per_second(StampUnit unit) {
  switch (unit) {
    case StampUnit::kSeconds:
      return 1;
    case StampUnit::kMilliseconds:
      return 1'000;
    case StampUnit::kMicroseconds:
      return 1'000'000;
    case StampUnit::kNanoseconds:
      return kBillion;
  }
  return 1;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool all_digits(std::string_view text) { return !text.empty() && std::all_of(text.begin(), text.end(), is_digit); }

// ".76" is 760'000'000 billionths; digits behind the ninth count nothing.
std::int64_t billionths_of(std::string_view digits) {
  std::int64_t sum = 0;
  std::int64_t place = kBillion / 10;
  for (const char c : digits) {
    sum += place * (c - '0');
    place /= 10;
  }
  return sum;
}

std::optional<std::int64_t> parse_whole(std::string_view digits) {
  const std::optional<std::uint64_t> value = all_digits(digits) ? parse_count(digits) : std::nullopt;
  if (!value || *value > static_cast<std::uint64_t>(INT64_MAX)) return std::nullopt;
  return static_cast<std::int64_t>(*value);
}

// numpy writes "1.403636579763555527e+09" unless told otherwise; a double is all that is left of it then.
std::optional<StampText> parse_with_exponent(std::string_view word) {
  const std::optional<double> value = parse_real(word);
  if (!value || !(*value >= 0.0) || *value > 9.2e18) return std::nullopt;
  const double whole = std::floor(*value);
  const auto rest = static_cast<std::int64_t>((*value - whole) * 1e9);
  return StampText{static_cast<std::int64_t>(whole), std::clamp<std::int64_t>(rest, 0, kBillion - 1), true};
}

std::vector<std::int64_t> sorted_wholes(std::span<const StampText> stamps) {
  std::vector<std::int64_t> wholes;
  wholes.reserve(stamps.size());
  for (const StampText& stamp : stamps) wholes.push_back(stamp.whole);
  std::sort(wholes.begin(), wholes.end());
  return wholes;
}

// The middle one of all steps from one to the next, without units.
double median_step(const std::vector<std::int64_t>& sorted) {
  if (sorted.size() < 2) return 0.0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < sorted.size(); ++i) steps.push_back(static_cast<double>(sorted[i] - sorted[i - 1]));
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Between September 2001 and December 2099.
bool is_of_this_century(std::int64_t value, StampUnit unit) {
  const std::int64_t seconds = value / units_per_second(unit);
  return seconds >= 1'000'000'000 && seconds < 4'102'444'800;
}

// Whether seconds with a fraction go by as scans come. "lidar0_000000012" and "20231114_221400100", a counter and a day
// with its time, read as seconds and nanoseconds, stand about still.
bool are_as_slow_as_scans(std::span<const StampText> stamps) {
  constexpr std::int64_t kFastest = 1'000'000;  // billionths
  std::vector<std::pair<std::int64_t, std::int64_t>> times;
  times.reserve(stamps.size());
  for (const StampText& stamp : stamps) times.emplace_back(stamp.whole, stamp.billionths);
  std::sort(times.begin(), times.end());
  std::size_t slow = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const std::int64_t wholes = times[i].first - times[i - 1].first;
    if (wholes > 1 || wholes * kBillion + times[i].second - times[i - 1].second >= kFastest) ++slow;
  }
  return 2 * slow + 1 >= times.size();
}

std::string as_text(const StampText& stamp) {
  return stamp.has_point ? fmt::format("{}.{:03}", stamp.whole, stamp.billionths / 1'000'000)
                         : fmt::format("{}", stamp.whole);
}

}  // namespace

std::string_view symbol_of(StampUnit unit) {
  constexpr std::array<std::string_view, kUnits.size()> kSymbols = {"s", "ms", "us", "ns"};
  return kSymbols[static_cast<std::size_t>(unit)];
}

std::optional<StampText> parse_stamp_text(std::string_view word) {
  if (word.find_first_of("eE") != std::string_view::npos) return parse_with_exponent(word);
  const std::size_t point = word.find('.');
  const std::optional<std::int64_t> whole = parse_whole(word.substr(0, point));
  if (!whole) return std::nullopt;
  if (point == std::string_view::npos) return StampText{*whole, 0, false};
  const std::string_view digits = word.substr(point + 1);
  if (!digits.empty() && !all_digits(digits)) return std::nullopt;
  return StampText{*whole, billionths_of(digits), true};
}

std::optional<StampText> stamp_of_file(std::string_view name) {
  std::string_view stem = name.substr(0, name.rfind('.'));
  stem.remove_prefix(
      std::min(stem.size(), static_cast<std::size_t>(std::find_if(stem.begin(), stem.end(), is_digit) - stem.begin())));
  const std::size_t underscore = stem.find('_');
  if (underscore == std::string_view::npos) return parse_stamp_text(stem);
  // Nine digits of nanoseconds, or a time of this century if their leading zeros are gone: "robot1_000012" is neither.
  const std::string_view fraction = stem.substr(underscore + 1);
  const std::optional<std::int64_t> seconds = parse_whole(stem.substr(0, underscore));
  const std::optional<std::int64_t> nanoseconds = parse_whole(fraction);
  if (!seconds || !nanoseconds || *nanoseconds >= kBillion) return std::nullopt;
  if (fraction.size() != 9 && !is_of_this_century(*seconds, StampUnit::kSeconds)) return std::nullopt;
  return StampText{*seconds, *nanoseconds, true};
}

bool look_like_stamps(std::span<const StampText> stamps) {
  const bool has_time = std::any_of(stamps.begin(), stamps.end(), [](const StampText& stamp) {
    return std::any_of(kUnits.begin(), kUnits.end(),
                       [&](StampUnit unit) { return is_of_this_century(stamp.whole, unit); });
  });
  if (has_time) return true;
  const bool has_point = std::any_of(stamps.begin(), stamps.end(), [](const auto& stamp) { return stamp.has_point; });
  return has_point && are_as_slow_as_scans(stamps);
}

StampUnit guess_unit(std::span<const StampText> stamps) {
  if (stamps.empty()) return StampUnit::kSeconds;
  constexpr double kLongestStep_s = 1000.0;
  const std::vector<std::int64_t> wholes = sorted_wholes(stamps);
  const double step = median_step(wholes);
  for (const StampUnit unit : kUnits) {
    if (is_of_this_century(wholes.back(), unit) &&
        step < kLongestStep_s * static_cast<double>(units_per_second(unit))) {
      return unit;
    }
  }
  // A clock that began at zero. Scans come every 10 ms to 10 s; mere counts (step 1) pass for seconds.
  const bool has_point = std::any_of(stamps.begin(), stamps.end(), [](const auto& stamp) { return stamp.has_point; });
  if (has_point || step < 1e4) return StampUnit::kSeconds;
  return step < 1e7 ? StampUnit::kMicroseconds : StampUnit::kNanoseconds;
}

std::optional<std::vector<std::int64_t>> to_nanoseconds(std::span<const StampText> stamps, StampUnit unit) {
  const std::int64_t factor = kBillion / units_per_second(unit);
  std::vector<std::int64_t> stamps_ns;
  stamps_ns.reserve(stamps.size());
  for (const StampText& stamp : stamps) {
    if (stamp.whole > INT64_MAX / factor - 1) return std::nullopt;
    stamps_ns.push_back(stamp.whole * factor + stamp.billionths / (kBillion / factor));
  }
  return stamps_ns;
}

std::string range_of(std::span<const StampText> stamps, StampUnit unit) {
  KILTER_EXPECTS(!stamps.empty());
  const auto earlier = [](const StampText& a, const StampText& b) {
    return a.whole != b.whole ? a.whole < b.whole : a.billionths < b.billionths;
  };
  const auto [low, high] = std::minmax_element(stamps.begin(), stamps.end(), earlier);
  return fmt::format("{} to {}, in {}", as_text(*low), as_text(*high), symbol_of(unit));
}

}  // namespace kilter
