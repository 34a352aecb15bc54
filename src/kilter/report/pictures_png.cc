// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/pictures_png.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "kilter/report/image.h"

namespace kilter {
namespace {

constexpr Rgb kPaper = {255, 255, 255};
constexpr Rgb kHollow = {238, 241, 244};
constexpr Rgb kInk = {22, 32, 43};
constexpr int kMatrixPixels = 640;
constexpr int kMostCells = 1000;  // along a side of a matrix
constexpr int kMapPixels = 1200;
constexpr int kMargin = 16;
// Around the sensor's height: walls without floor and ceiling, as the report starts. [m]
constexpr double kSliceLow_m = -0.7;
constexpr double kSliceHigh_m = 0.9;
// A finished cloud has no sensor: one is taken to have stood so far above its floor, which few points lie below.
constexpr double kSensorAboveFloor_m = 1.2;
constexpr double kBelowFloor = 0.05;
constexpr double kLeastInSlice = 0.05;  // of all points: with fewer the map would look empty, so all are drawn

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

// How large a matrix is drawn: beyond kMostCells submaps several share a row of cells, for an image with two pixels for
// each of 10,000 squared is of no use to anybody, and a gigabyte.
struct CellSize {
  explicit CellSize(int count)
      : submaps(std::max(1, (count + kMostCells - 1) / kMostCells)),
        cells(std::max(1, (count + submaps - 1) / submaps)),
        pixels(std::max(2, (kMatrixPixels - 2 * kMargin) / cells)),
        side(cells * pixels) {}

  // Where the cell of a submap begins.
  [[nodiscard]] int pixel(int submap) const { return kMargin + submap / submaps * pixels; }

  int submaps;  // that share a cell's edge
  int cells;    // along a side
  int pixels;   // of a cell
  int side;     // in pixels
};

void draw_blocks(Image& image, const Result& result, const CellSize& size) {
  int first = 0;
  for (std::size_t robot = 0; robot < result.robots.size(); ++robot) {
    const int from = size.pixel(first);
    first += result.robots[robot].submaps;
    const int to = size.pixel(first + size.submaps - 1);
    const int side = size.side;
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

Rgb paler(Rgb colour) {
  for (std::uint8_t& channel : colour) channel = static_cast<std::uint8_t>((channel + 2 * 255) / 3);
  return colour;
}

// Colours of the submaps' points: their robots', paler.
std::vector<Rgb> colours_of_submaps(const Result& result) {
  std::vector<Rgb> colours;
  colours.reserve(result.submaps.size());
  std::size_t robot = 0;
  for (const SubmapSummary& submap : result.submaps) {
    // Submaps come robot by robot, in the robots' order.
    while (robot + 1 < result.robots.size() && result.robots[robot].name != submap.robot) ++robot;
    colours.push_back(paler(robot_colour(static_cast<int>(robot))));
  }
  return colours;
}

// The value below which a share of the numbers lies; 0 of none.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  const auto at = values.begin() + std::min(last, static_cast<std::ptrdiff_t>(share * static_cast<double>(last + 1)));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// What the map shows, and where.
class MapScene {
 public:
  explicit MapScene(const Result& result) : result_(result) {
    std::size_t all = 0;
    std::size_t between = 0;
    for (std::size_t i = 0; i < result.submaps.size(); ++i) {
      sensors_m_.push_back(sensor_height_m(i));
      all += result.picture->clouds[i].points.size();
    }
    visit([&](std::size_t, const Eigen::Vector3d&) { ++between; });
    sliced_ = static_cast<double>(between) >= kLeastInSlice * static_cast<double>(all);
  }

  // Calls visit(submap, point in the world) for each point that is drawn.
  template <typename Visit>
  void visit(const Visit& visit) const {
    for (std::size_t i = 0; i < result_.submaps.size(); ++i) {
      const CloudPicture& cloud = result_.picture->clouds[i];
      const Eigen::Isometry3d T = result_.submaps[i].T_world_submap.isometry();
      for (std::size_t k = 0; k < cloud.points.size(); ++k) {
        const Eigen::Vector3d point_m = T * cloud.point_m(k);
        const double height_m = point_m.z() - sensors_m_[i];
        if (!sliced_ || (height_m >= kSliceLow_m && height_m <= kSliceHigh_m)) visit(i, point_m);
      }
    }
  }

  // The place that stands for a submap: its start, or the middle of a finished cloud, whose pose tells of no robot.
  [[nodiscard]] Eigen::Vector3d place_m(const SubmapSummary& submap) const {
    if (submap.scans) return submap.T_world_submap.translation_m();
    const auto i = static_cast<std::size_t>(submap.id.value);
    return {coordinate_m(i, 0, 0.5), coordinate_m(i, 1, 0.5), coordinate_m(i, 2, 0.5)};
  }

  // Where the robots were, and most of the points around them: single far ones must not shrink the map. Of finished
  // clouds most of their points.
  [[nodiscard]] Eigen::AlignedBox2d extent() const {
    Eigen::AlignedBox2d box = seen_from();
    if (box.isEmpty()) return {Eigen::Vector2d(-1.0, -1.0), Eigen::Vector2d(1.0, 1.0)};
    std::vector<double> reach_m;
    visit([&](std::size_t, const Eigen::Vector3d& point_m) {
      reach_m.push_back(std::sqrt(box.squaredExteriorDistance(Eigen::Vector2d(point_m.head<2>()))));
    });
    const double most_m = percentile(std::move(reach_m), 0.97);
    const Eigen::Vector2d margin =
        Eigen::Vector2d::Constant(1.0 + std::min(most_m, 0.5 * box.sizes().maxCoeff() + 10.0));
    return {Eigen::Vector2d(box.min() - margin), Eigen::Vector2d(box.max() + margin)};
  }

 private:
  // Of a submap's points in the world, the coordinate along an axis that a share of them lies below.
  [[nodiscard]] double coordinate_m(std::size_t submap, int axis, double share) const {
    const CloudPicture& cloud = result_.picture->clouds[submap];
    const Eigen::Isometry3d T = result_.submaps[submap].T_world_submap.isometry();
    std::vector<double> values_m;
    values_m.reserve(cloud.points.size());
    for (std::size_t k = 0; k < cloud.points.size(); ++k) values_m.push_back((T * cloud.point_m(k))[axis]);
    return percentile(std::move(values_m), share);
  }

  [[nodiscard]] double sensor_height_m(std::size_t submap) const {
    if (result_.submaps[submap].scans) return result_.submaps[submap].T_world_submap.translation_m().z();
    return coordinate_m(submap, 2, kBelowFloor) + kSensorAboveFloor_m;
  }

  [[nodiscard]] Eigen::AlignedBox2d seen_from() const {
    Eigen::AlignedBox2d box;
    for (std::size_t robot = 0; robot < result_.robots.size(); ++robot) {
      if (result_.robots[robot].finished_submaps) continue;
      for (const Eigen::Vector3d& point_m : result_.picture->paths[robot]) {
        box.extend(Eigen::Vector2d(point_m.head<2>()));
      }
    }
    for (std::size_t i = 0; i < result_.submaps.size(); ++i) {
      if (result_.submaps[i].scans || result_.picture->clouds[i].points.empty()) continue;
      for (const double share : {0.02, 0.98}) {
        box.extend(Eigen::Vector2d(coordinate_m(i, 0, share), coordinate_m(i, 1, share)));
      }
    }
    return box;
  }

  const Result& result_;
  std::vector<double> sensors_m_;  // by submap, in the world
  bool sliced_ = true;
};

void draw_pairs(Image& image, const TopView& view, const MapScene& scene, const Result& result, Verdict verdict) {
  for (const PairResult& pair : result.pairs) {
    if (pair.verdict.verdict != verdict) continue;
    const Eigen::Vector2d a = view.pixel(scene.place_m(result.submap(pair.id.target)));
    const Eigen::Vector2d b = view.pixel(scene.place_m(result.submap(pair.id.source)));
    image.line(a.x(), a.y(), b.x(), b.y(), verdict == Verdict::kInconsistent ? 3 : 1, verdict_colour(verdict),
               verdict == Verdict::kUnverified ? 4 : 0);
  }
}

}  // namespace

std::string matrix_png(const Result& result, const std::map<PairId, double>& cells, const std::vector<double>& scaled) {
  const CellSize size(static_cast<int>(result.submaps.size()));
  Image image(size.side + 2 * kMargin, size.side + 2 * kMargin, kPaper);
  for (int row = 0; row < size.cells; ++row) {
    image.fill(kMargin, kMargin + row * size.pixels, (row + 1) * size.pixels, size.pixels, kHollow);
  }
  const LogRange range = range_of(scaled);
  for (const auto& [id, value] : cells) {
    const Rgb colour = value > 0.0 ? scale_colour(range.share(value)) : below_scale_colour();
    image.fill(size.pixel(id.target.value), size.pixel(id.source.value), size.pixels, size.pixels, colour);
  }
  draw_blocks(image, result, size);
  if (size.side >= 300) draw_colour_bar(image, range);
  return image.png();
}

std::string map_png(const Result& result) {
  const MapScene scene(result);
  const TopView view(scene.extent());
  Image image(view.width(), view.height(), kPaper);
  const std::vector<Rgb> colours = colours_of_submaps(result);
  scene.visit([&](std::size_t submap, const Eigen::Vector3d& point_m) {
    const Eigen::Vector2d at = view.pixel(point_m);
    if (!(at.cwiseAbs().maxCoeff() < 1e6)) return;
    image.set(static_cast<int>(at.x()), static_cast<int>(at.y()), colours[submap]);
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
    draw_pairs(image, view, scene, result, verdict);
  }
  return image.png();
}

}  // namespace kilter
