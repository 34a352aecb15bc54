// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/coarse_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "kilter/registration/best_moves.h"

namespace kilter {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kCellVoxels = 4;
constexpr std::size_t kMostCells = 1U << 24;  // the cell grows where the box would need more
constexpr std::size_t kUprightPoints = 600;
constexpr std::size_t kLevelPoints = 200;
constexpr int kFacings = 16;  // sectors of azimuth that upright points are balanced over
constexpr double kUprightSlope = 0.5;
constexpr double kLevelSlope = 0.85;
constexpr int kLeastUpright = 30;
constexpr double kLevelShare = 0.3;  // of the score, for floors and ceilings
constexpr std::size_t kLookedAtTwice = 64;
// Worth of a cell in sixths: a surface in it, a surface beside it, free space.
constexpr std::int8_t kMet = 6;
constexpr std::int8_t kBeside = 3;
constexpr std::int8_t kThroughFree = -2;

enum class Facing { kUpright, kLevel, kOther };

Facing facing_of(const Vector3d& normal_up, double& azimuth) {
  azimuth = std::atan2(normal_up.y(), normal_up.x());
  if (normal_up.isZero()) return Facing::kOther;
  const double slope = std::abs(normal_up.z());
  return slope <= kUprightSlope ? Facing::kUpright : slope >= kLevelSlope ? Facing::kLevel : Facing::kOther;
}

// Axes whose third is the vertical.
Eigen::Matrix3d upright_axes(const Vector3d& up) {
  const Vector3d x = up.unitOrthogonal();
  Eigen::Matrix3d R;
  R.row(0) = x;
  R.row(1) = up.cross(x);
  R.row(2) = up;
  return R;
}

// One byte a cell over the target's box, in upright axes, with a rim so that neighbours exist.
class WorthGrid {
 public:
  WorthGrid(const Eigen::AlignedBox3d& box, double cell_m)
      : cell_m_(cell_m), origin_m_(box.min().array() - 2.0 * cell_m) {
    size_ = ((box.sizes() / cell_m).array().ceil().matrix().cast<int>().array() + 5).matrix();
    worth_.assign(
        static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()),
        0);
  }

  [[nodiscard]] Vector3i cell_of(const Vector3d& at_m) const {
    return ((at_m - origin_m_) / cell_m_).array().floor().matrix().cast<int>();
  }

  // Adds weight * worth to sums[k] for the cells first + (k, 0, 0); those outside are worth nothing.
  void add_row(const Vector3i& first, double weight, std::span<double> sums) const {
    if (first.y() < 0 || first.y() >= size_.y() || first.z() < 0 || first.z() >= size_.z()) return;
    const int skipped = std::max(-first.x(), 0);
    const int count = std::min(static_cast<int>(sums.size()), size_.x() - first.x()) - skipped;
    if (count <= 0) return;
    const std::int8_t* const worth = worth_.data() + slot({first.x() + skipped, first.y(), first.z()});
    double* const to = sums.data() + skipped;
    for (int k = 0; k < count; ++k) to[k] += weight * worth[k];
  }

  void mark_surface(const Vector3d& at_m) { worth_[slot(cell_of(at_m))] = kMet; }

  void mark_free(const Vector3d& at_m) {
    const Vector3i cell = cell_of(at_m);
    if (holds(cell) && worth_[slot(cell)] == 0) worth_[slot(cell)] = kThroughFree;
  }

  // Cells beside a surface are worth something, whatever else they are.
  void widen_surfaces() {
    const std::vector<std::int8_t> before = worth_;
    for (int z = 1; z + 1 < size_.z(); ++z) {
      for (int y = 1; y + 1 < size_.y(); ++y) {
        for (int x = 1; x + 1 < size_.x(); ++x) {
          if (before[slot({x, y, z})] != kMet) continue;
          for (int n = 0; n < 27; ++n) {
            std::int8_t& near = worth_[slot({x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1})];
            near = std::max(near, kBeside);
          }
        }
      }
    }
  }

 private:
  [[nodiscard]] bool holds(const Vector3i& c) const {
    return (c.array() >= 0).all() && (c.array() < size_.array()).all();
  }
  [[nodiscard]] std::size_t slot(const Vector3i& c) const {
    return (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(c.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(c.x());
  }

  double cell_m_;
  Vector3d origin_m_;
  Vector3i size_;
  std::vector<std::int8_t> worth_;
};

struct Target {
  WorthGrid upright;
  WorthGrid level;
};

double cell_size_m(const Eigen::AlignedBox3d& box, double resolution_m) {
  double cell_m = kCellVoxels * resolution_m;
  while (((box.sizes() / cell_m).array() + 5.0).prod() > static_cast<double>(kMostCells)) cell_m *= 1.5;
  return cell_m;
}

Target grid_of(const VoxelMap& map, const Eigen::Matrix3d& R_up_target, const Eigen::AlignedBox3d& box, double cell_m) {
  Target target{WorthGrid(box, cell_m), WorthGrid(box, cell_m)};
  const SurfaceVoxels& voxels = map.voxels();
  double azimuth = 0.0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Vector3d at_m = R_up_target * voxels.centroids_m[i].cast<double>();
    const Facing facing = facing_of(R_up_target * voxels.normals[i].cast<double>(), azimuth);
    if (facing != Facing::kLevel) target.upright.mark_surface(at_m);
    if (facing != Facing::kUpright) target.level.mark_surface(at_m);
  }
  target.upright.widen_surfaces();
  target.level.widen_surfaces();
  const double half_m = 0.5 * kCellVoxels * map.resolution_m();
  for (const VoxelBlock& block : map.blocks()) {
    // One probe for each half of a block's side: a cell is four voxels wide.
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3i low =
          block_of_key(block.key) * kBlockSize + 4 * Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
      const Vector3i middle = low + Vector3i(2, 2, 2);
      if (map.state(middle) != CellState::kFree || map.state(middle - Vector3i::Ones()) != CellState::kFree) continue;
      const Vector3d at_m = R_up_target * (low.cast<double>() * map.resolution_m() + Vector3d::Constant(half_m)).eval();
      target.upright.mark_free(at_m);
      target.level.mark_free(at_m);
    }
  }
  return target;
}

// The source's points in upright axes, turned by the start's rotation but not shifted.
struct SamplePoint {
  Vector3d at_m;
  double weight = 0.0;
};

struct Sample {
  std::vector<SamplePoint> upright;
  std::vector<SamplePoint> level;
  Vector3d middle_m = Vector3d::Zero();
  double radius_m = 0.0;  // RMS distance of upright points from the vertical through the middle
};

void pick(std::vector<SamplePoint>& from, std::size_t most, double total_weight) {
  const std::size_t count = std::min(most, from.size());
  std::vector<SamplePoint> picked;
  picked.reserve(count);
  for (std::size_t k = 0; k < count; ++k) picked.push_back(from[k * from.size() / count]);
  double sum = 0.0;
  for (const SamplePoint& p : picked) sum += p.weight;
  for (SamplePoint& p : picked) p.weight *= total_weight / sum;
  from = std::move(picked);
}

Sample sample_of(const VoxelMap& map, const Eigen::Isometry3d& T_up_source) {
  Sample sample;
  const SurfaceVoxels& voxels = map.voxels();
  std::array<std::vector<SamplePoint>, kFacings> sectors;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    double azimuth = 0.0;
    const Facing facing = facing_of(T_up_source.linear() * voxels.normals[i].cast<double>(), azimuth);
    const SamplePoint point{T_up_source * voxels.centroids_m[i].cast<double>(), 1.0};
    if (facing == Facing::kLevel) sample.level.push_back(point);
    if (facing != Facing::kUpright) continue;
    const int sector = static_cast<int>((azimuth / (2.0 * std::numbers::pi) + 0.5) * kFacings) % kFacings;
    sectors[static_cast<std::size_t>(sector)].push_back(point);
  }
  // Between "each point counts" and "each facing counts": a sector of n points gets n^(1/2) of the picks.
  double roots = 0.0;
  for (const auto& sector : sectors) roots += std::sqrt(static_cast<double>(sector.size()));
  for (auto& sector : sectors) {
    if (sector.empty()) continue;
    const double share = std::sqrt(static_cast<double>(sector.size())) / roots;
    pick(sector, static_cast<std::size_t>(std::ceil(share * kUprightPoints)), share);
    sample.upright.insert(sample.upright.end(), sector.begin(), sector.end());
  }
  if (!sample.level.empty()) pick(sample.level, kLevelPoints, 1.0);
  for (const SamplePoint& p : sample.upright) sample.middle_m += p.weight * p.at_m;
  double square_m2 = 0.0;
  for (const SamplePoint& p : sample.upright)
    square_m2 += p.weight * (p.at_m - sample.middle_m).head<2>().squaredNorm();
  sample.radius_m = std::sqrt(square_m2);
  return sample;
}

std::vector<SamplePoint> turned(const std::vector<SamplePoint>& points, const Vector3d& middle_m, double angle_rad) {
  const Eigen::AngleAxisd rotation(angle_rad, Vector3d::UnitZ());
  std::vector<SamplePoint> out = points;
  for (SamplePoint& p : out) p.at_m = rotation * (p.at_m - middle_m) + middle_m;
  return out;
}

// Scores of the shifts first, first + (1, 0, 0), ... Each is summed over the points in their order, so that a row gives
// what one shift at a time would.
void score_row(const WorthGrid& grid, const std::vector<Vector3i>& cells, const std::vector<SamplePoint>& points,
               const Vector3i& first, std::span<double> scores) {
  std::fill(scores.begin(), scores.end(), 0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) grid.add_row(cells[i] + first, points[i].weight, scores);
  for (double& score : scores) score /= kMet;
}

double score_at(const WorthGrid& grid, const std::vector<Vector3i>& cells, const std::vector<SamplePoint>& points,
                const Vector3i& shift) {
  double score = 0.0;
  score_row(grid, cells, points, shift, {&score, 1});
  return score;
}

std::vector<Vector3i> cells_of(const WorthGrid& grid, const std::vector<SamplePoint>& points) {
  std::vector<Vector3i> cells(points.size());
  std::transform(points.begin(), points.end(), cells.begin(), [&](const auto& p) { return grid.cell_of(p.at_m); });
  return cells;
}

// In cells and steps of turning; `circle` steps are a whole turn.
Nearness same_peak(double circle) { return {1, 2, circle}; }
// A descent from either would end in the same optimum: 0.8 m at voxels of 0.1 m.
Nearness same_basin(double circle) { return {2, 3, circle}; }

}  // namespace

std::vector<CoarsePose> coarse_search(const VoxelMap& source, const VoxelMap& target, const Pose3& start,
                                      const CoarseSearchRange& range, const Vector3d& up_target, int keep) {
  const Eigen::Matrix3d R_up_target = upright_axes(up_target);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& c : target.voxels().centroids_m) box.extend((R_up_target * c.cast<double>()).eval());
  Eigen::Isometry3d T_up_source = start.isometry();
  T_up_source.prerotate(R_up_target);
  const Sample sample = sample_of(source, T_up_source);
  if (box.isEmpty() || sample.upright.size() < kLeastUpright) return {};

  const double cell_m = cell_size_m(box, target.resolution_m());
  const Target grid = grid_of(target, R_up_target, box, cell_m);
  const int rise = static_cast<int>(std::ceil(range.vertical_m / cell_m));
  const double turn_rad = cell_m / std::max(1.5 * sample.radius_m, 4.0 * cell_m);
  const double circle = 2.0 * std::numbers::pi / turn_rad;
  const int turns = static_cast<int>(std::min(std::ceil(range.rotation_rad / turn_rad), std::floor(0.5 * circle)));

  BestMoves best(kLookedAtTwice, same_peak(circle));
  std::vector<double> scores;
  for (int turn = -turns; turn <= turns; ++turn) {
    const std::vector<SamplePoint> points = turned(sample.upright, sample.middle_m, turn * turn_rad);
    const std::vector<Vector3i> cells = cells_of(grid.upright, points);
    // A turn about the far end of the source moves its middle, too.
    const double lever_m = 2.0 * std::sin(0.5 * std::abs(turn * turn_rad)) * sample.radius_m;
    const int reach = static_cast<int>(std::ceil((range.translation_m + lever_m) / cell_m));
    for (int y = -reach; y <= reach; ++y) {
      int side = reach;
      while (side * side + y * y > reach * reach) --side;
      scores.resize(2 * static_cast<std::size_t>(side) + 1);
      score_row(grid.upright, cells, points, {-side, y, 0}, scores);
      for (int x = -side; x <= side; ++x) {
        const int number = x + side;
        best.offer({{x, y, 0}, turn, scores[static_cast<std::size_t>(number)]});
      }
    }
  }
  std::vector<Move> closer;
  for (const Move& move : best.peaks()) {
    const std::vector<SamplePoint> upright = turned(sample.upright, sample.middle_m, move.turn * turn_rad);
    const std::vector<SamplePoint> level = turned(sample.level, sample.middle_m, move.turn * turn_rad);
    const std::vector<Vector3i> upright_cells = cells_of(grid.upright, upright);
    const std::vector<Vector3i> level_cells = cells_of(grid.level, level);
    for (int z = -rise; z <= rise; ++z) {
      const Vector3i shift = move.cells + Vector3i(0, 0, z);
      closer.push_back({shift, move.turn,
                        (1.0 - kLevelShare) * score_at(grid.upright, upright_cells, upright, shift) +
                            kLevelShare * score_at(grid.level, level_cells, level, shift)});
    }
  }
  std::vector<CoarsePose> poses;
  for (const Move& move : peaks(std::move(closer), static_cast<std::size_t>(keep), same_basin(circle))) {
    const Eigen::Quaterniond turn_up(Eigen::AngleAxisd(move.turn * turn_rad, Vector3d::UnitZ()));
    const Vector3d shift_m = cell_m * move.cells.cast<double>();
    const Pose3 moved_up(turn_up, sample.middle_m - turn_up * sample.middle_m + shift_m);
    const Pose3 R_up(Eigen::Quaterniond(R_up_target), Vector3d::Zero());
    poses.push_back({R_up.inverse() * moved_up * R_up * start, move.score});
  }
  return poses;
}

}  // namespace kilter
