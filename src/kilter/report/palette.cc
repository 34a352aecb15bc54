// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/palette.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "kilter/pipeline/picture.h"
#include "kilter/report/json_writer.h"

namespace kilter {
namespace {

// Chosen by brightness as well as by hue.
constexpr std::array<Rgb, 8> kRobots = {{{31, 105, 179},
                                         {240, 149, 10},
                                         {16, 150, 110},
                                         {200, 60, 40},
                                         {110, 190, 240},
                                         {140, 80, 160},
                                         {235, 220, 70},
                                         {90, 90, 90}}};
constexpr Rgb kConsistent = {42, 157, 143};
constexpr Rgb kInconsistent = {209, 18, 63};
constexpr Rgb kUnverified = {128, 144, 162};
constexpr Rgb kBelow = {150, 156, 162};
constexpr std::array<Rgb, 10> kScale = {{{68, 1, 84},
                                         {72, 40, 120},
                                         {62, 74, 137},
                                         {49, 104, 142},
                                         {38, 130, 142},
                                         {31, 158, 137},
                                         {53, 183, 121},
                                         {110, 206, 88},
                                         {181, 222, 43},
                                         {253, 231, 37}}};
// The first where nothing was decided; the middle of the rest is the tolerance.
constexpr std::array<Rgb, 6> kMisalignment = {
    {{150, 156, 162}, {70, 120, 170}, {110, 165, 190}, {235, 185, 40}, {230, 95, 15}, {190, 0, 50}}};

Rgb along(std::span<const Rgb> stops, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double mix = at - static_cast<double>(low);
  Rgb colour{};
  for (std::size_t c = 0; c < colour.size(); ++c) {
    colour[c] = static_cast<std::uint8_t>(std::lround(stops[low][c] + mix * (stops[low + 1][c] - stops[low][c])));
  }
  return colour;
}

void write_colour(JsonWriter& json, const Rgb& colour) {
  json.open_list(JsonWriter::Layout::kCompact);
  for (const std::uint8_t channel : colour) json.value(static_cast<int>(channel));
  json.close();
}

void write_colours(JsonWriter& json, std::string_view name, std::span<const Rgb> colours) {
  json.key(name).open_list(JsonWriter::Layout::kCompact);
  for (const Rgb& colour : colours) write_colour(json, colour);
  json.close();
}

}  // namespace

Rgb robot_colour(int robot) { return kRobots[static_cast<std::size_t>(robot) % kRobots.size()]; }

Rgb verdict_colour(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return kConsistent;
    case Verdict::kInconsistent:
      return kInconsistent;
    case Verdict::kUnverified:
      return kUnverified;
  }
  return kUnverified;
}

Rgb scale_colour(double share) { return along(kScale, share); }

Rgb below_scale_colour() { return kBelow; }

Rgb misalignment_colour(std::uint8_t byte, double tolerance_m) {
  if (byte == 0) return kMisalignment.front();
  const double tenths = 10.0 * (byte - 1) * Picture::kMisalignmentStep_m / tolerance_m;
  return along(std::span(kMisalignment).subspan(1), tenths <= 1.0 ? 0.0 : std::log10(tenths) / 2.0);
}

std::string palette_json() {
  JsonWriter json;
  json.open_object(JsonWriter::Layout::kCompact);
  write_colours(json, "robots", kRobots);
  json.key("verdicts").open_object(JsonWriter::Layout::kCompact);
  for (const Verdict verdict : {Verdict::kConsistent, Verdict::kInconsistent, Verdict::kUnverified}) {
    json.key(to_string(verdict));
    write_colour(json, verdict_colour(verdict));
  }
  json.close();
  write_colours(json, "scale", kScale);
  json.key("below");
  write_colour(json, kBelow);
  write_colours(json, "misalignment", kMisalignment);
  return json.close().take();
}

}  // namespace kilter
