// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/pictures_png.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "kilter/report/image.h"

namespace kilter {
namespace {

constexpr Rgb kPaper = {255, 255, 255};
constexpr Rgb kHollow = {238, 241, 244};
constexpr Rgb kInk = {22, 32, 43};
constexpr int kMatrixPixels = 640;
constexpr int kMapPixels = 1200;
constexpr int kMargin = 16;
// Around the sensor's height: walls without floor and ceiling, as the report starts. [m]
constexpr double kSliceLow_m = -0.7;
constexpr double kSliceHigh_m = 0.9;

struct LogRange {
  double low = 0.0;
  double high = 1.0;

  [[nodiscard]] double share(double value) const { return high > low ? (std::log10(value) - low) / (high - low) : 0.5; }
};

LogRange range_of(const std::vector<double>& values) {
  std::optional<LogRange> range;
  for (const double value : values) {
    if (!(value > 0.0)) continue;
    const double power = std::log10(value);
    if (!range) range = LogRange{power, power};
    range->low = std::min(range->low, power);
    range->high = std::max(range->high, power);
  }
  return range.value_or(LogRange{});
}

void draw_colour_bar(Image& image, const LogRange& range) {
  constexpr int kLong = 180;
  constexpr int kHigh = 12;
  const int left = image.width() - kMargin - kLong;
  for (int x = 0; x < kLong; ++x) image.fill(left + x, 36, 1, kHigh, scale_colour(x / double{kLong - 1}));
  const std::string low = fmt::format("{:.2g}", std::pow(10.0, range.low));
  const std::string high = fmt::format("{:.2g}", std::pow(10.0, range.high));
  image.digits(left, 20, low, 2, kInk);
  image.digits(image.width() - kMargin - 8 * static_cast<int>(high.size()), 20, high, 2, kInk);
}

void draw_blocks(Image& image, const Result& result, int cell, int side) {
  int first = 0;
  for (std::size_t robot = 0; robot < result.robots.size(); ++robot) {
    const int from = kMargin + first * cell;
    first += result.robots[robot].submaps;
    const int to = kMargin + first * cell;
    const Rgb colour = robot_colour(static_cast<int>(robot));
    image.fill(kMargin - 8, from + 1, 5, to - from - 2, colour);
    image.fill(from + 1, kMargin + side + 3, to - from - 2, 5, colour);
    image.fill(from, from, 1, side - (from - kMargin), kInk);
    image.fill(kMargin, to - 1, to - kMargin, 1, kInk);
  }
}

// World x and y to pixels, north up.
class TopView {
 public:
  explicit TopView(const Eigen::AlignedBox2d& extent_m) : corner_m_(extent_m.min()) {
    const Eigen::Vector2d size_m = extent_m.sizes().cwiseMax(1.0);
    scale_ = (kMapPixels - 2.0 * kMargin) / size_m.maxCoeff();
    width_ = static_cast<int>(std::ceil(size_m.x() * scale_)) + 2 * kMargin;
    height_ = static_cast<int>(std::ceil(size_m.y() * scale_)) + 2 * kMargin;
  }
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector2d at = (point_m.head<2>() - corner_m_) * scale_;
    return {kMargin + at.x(), height_ - kMargin - at.y()};
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  Eigen::Vector2d corner_m_;
  double scale_ = 1.0;
  int width_ = 0;
  int height_ = 0;
};

int robot_of(const Result& result, const SubmapSummary& submap) {
  const auto found = std::find_if(result.robots.begin(), result.robots.end(),
                                  [&](const RobotSummary& robot) { return robot.name == submap.robot; });
  return static_cast<int>(found - result.robots.begin());
}

template <typename Visit>
void visit_slice(const Result& result, const Visit& visit) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const CloudPicture& cloud = result.picture->clouds[i];
    const Eigen::Isometry3d T = result.submaps[i].T_world_submap.isometry();
    for (std::size_t k = 0; k < cloud.points.size(); ++k) {
      const Eigen::Vector3d point_m = T * cloud.point_m(k);
      const double height_m = point_m.z() - T.translation().z();
      if (height_m >= kSliceLow_m && height_m <= kSliceHigh_m) visit(i, point_m);
    }
  }
}

// Where the robots were, and most of the points around them: single far ones must not shrink the map.
Eigen::AlignedBox2d extent_of(const Result& result) {
  Eigen::AlignedBox2d box;
  for (const auto& path : result.picture->paths) {
    for (const Eigen::Vector3d& point_m : path) box.extend(Eigen::Vector2d(point_m.head<2>()));
  }
  std::vector<double> reach_m;
  visit_slice(result, [&](std::size_t, const Eigen::Vector3d& point_m) {
    reach_m.push_back(std::sqrt(box.squaredExteriorDistance(Eigen::Vector2d(point_m.head<2>()))));
  });
  if (box.isEmpty()) return {Eigen::Vector2d(-1.0, -1.0), Eigen::Vector2d(1.0, 1.0)};
  double margin_m = 1.0;
  if (!reach_m.empty()) {
    const auto most = reach_m.begin() + static_cast<std::ptrdiff_t>(reach_m.size() * 97 / 100);
    std::nth_element(reach_m.begin(), most, reach_m.end());
    margin_m += std::min(*most, 0.5 * box.sizes().maxCoeff() + 10.0);
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(margin_m);
  return {Eigen::Vector2d(box.min() - margin), Eigen::Vector2d(box.max() + margin)};
}

void draw_pairs(Image& image, const TopView& view, const Result& result, Verdict verdict) {
  for (const PairResult& pair : result.pairs) {
    if (pair.verdict.verdict != verdict) continue;
    const Eigen::Vector2d a = view.pixel(result.submap(pair.id.target).T_world_submap.translation_m());
    const Eigen::Vector2d b = view.pixel(result.submap(pair.id.source).T_world_submap.translation_m());
    image.line(a.x(), a.y(), b.x(), b.y(), verdict == Verdict::kInconsistent ? 3 : 1, verdict_colour(verdict),
               verdict == Verdict::kUnverified ? 4 : 0);
  }
}

Rgb paler(Rgb colour) {
  for (std::uint8_t& channel : colour) channel = static_cast<std::uint8_t>((channel + 2 * 255) / 3);
  return colour;
}

}  // namespace

std::string matrix_png(const Result& result, const std::map<PairId, double>& cells, const std::vector<double>& scaled) {
  const int n = std::max(1, static_cast<int>(result.submaps.size()));
  const int cell = std::max(2, (kMatrixPixels - 2 * kMargin) / n);
  const int side = n * cell;
  Image image(side + 2 * kMargin, side + 2 * kMargin, kPaper);
  for (int row = 0; row < n; ++row) image.fill(kMargin, kMargin + row * cell, (row + 1) * cell, cell, kHollow);
  const LogRange range = range_of(scaled);
  for (const auto& [id, value] : cells) {
    const Rgb colour = value > 0.0 ? scale_colour(range.share(value)) : below_scale_colour();
    image.fill(kMargin + id.target.value * cell, kMargin + id.source.value * cell, cell, cell, colour);
  }
  draw_blocks(image, result, cell, side);
  if (side >= 300) draw_colour_bar(image, range);
  return image.png();
}

std::string map_png(const Result& result) {
  const TopView view(extent_of(result));
  Image image(view.width(), view.height(), kPaper);
  visit_slice(result, [&](std::size_t submap, const Eigen::Vector3d& point_m) {
    const Eigen::Vector2d at = view.pixel(point_m);
    if (!(at.cwiseAbs().maxCoeff() < 1e6)) return;
    image.set(static_cast<int>(at.x()), static_cast<int>(at.y()),
              paler(robot_colour(robot_of(result, result.submaps[submap]))));
  });
  for (std::size_t robot = 0; robot < result.picture->paths.size(); ++robot) {
    const auto& path = result.picture->paths[robot];
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Eigen::Vector2d a = view.pixel(path[i - 1]);
      const Eigen::Vector2d b = view.pixel(path[i]);
      image.line(a.x(), a.y(), b.x(), b.y(), 3, robot_colour(static_cast<int>(robot)));
    }
  }
  for (const Verdict verdict : {Verdict::kConsistent, Verdict::kUnverified, Verdict::kInconsistent}) {
    draw_pairs(image, view, result, verdict);
  }
  return image.png();
}

}  // namespace kilter
