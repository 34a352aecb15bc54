// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend_in_time.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kilter/registration/patches.h"
#include "kilter/registration/plane_matches.h"
#include "kilter/registration/sum_jacobians.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr std::size_t kFewestResiduals = 300;
constexpr std::size_t kFewestPlaces = 60;  // to stand for what both saw
// Scale of the law by which a submap drifts from one bin to the next, as a share of the kernel's: what a wide kernel
// sees may be a slip.
constexpr double kStepOfKernel = 0.2;
constexpr double kTie_m = 1.0;   // a bin is not thought to lie off by more
constexpr double kShrink = 0.6;  // of the kernel, from one round to the next
constexpr int kRematches = 2;    // places are matched so often once more
constexpr int kLastRounds = 4;   // at the final kernel, each time
// A patch lies off as a whole by this share of its mean square residual, and by this much of a voxel.
constexpr double kPatchShare = 0.3;
constexpr double kLeastPatchVoxels = 0.05;
constexpr double kWholePatch = 10.0;  // smaller ones (sum of weights) count by their share of this
// How far the measured RMS is from the true one, as a share of it: one standard deviation, seen where the truth is
// known.
constexpr double kScatter = 0.07;
// Of a voxel's edge: so far submaps that are rigid seem bent (seen at 0.1 m), and the pose is not moved for it.
constexpr double kNoiseVoxels = 0.1;

// Two ways to see the same scene at other times: what the source saw in one bin and the target in another.
struct Cell {
  int source = 0;  // unknowns 6 * source ..
  int target = 0;  // and 6 * target ..
  std::size_t first = 0;
  std::size_t last = 0;
};

// What is left of squares once the motion that all have in common is taken out.
struct SquareAboutMean {
  Matrix6 form = Matrix6::Zero();
  Vector6 pull = Vector6::Zero();
  double square = 0.0;

  void add(const Matrix6& of_place, const Vector6& motion) {
    form += of_place;
    pull += of_place * motion;
    square += motion.dot(of_place * motion);
  }
  [[nodiscard]] Vector6 common() const { return form.ldlt().solve(pull); }
  [[nodiscard]] double left() const { return square - pull.dot(common()); }
};

// All that one solution of the weighted problem needs and leaves.
class TimedMotions {
 public:
  TimedMotions(std::span<const PlaneResidual> residuals, const PairGrain& grain);

  // Goes on with other matches of the same submaps.
  void take(std::span<const PlaneResidual> residuals);
  [[nodiscard]] MotionsInTime motions() const;
  // Where the residuals lie.
  [[nodiscard]] std::vector<CommonPlace> places() const { return places_of(residuals_, place_edge_m(grain_)); }
  // One round at this scale of the kernel.
  void improve(double scale_m);
  // What the motions leave apart of these places.
  [[nodiscard]] Bend bend(std::span<const CommonPlace> places) const;

 private:
  // Numbers of the unknown motions, of a bin of time: its own, or the one that a submap has which knows no times.
  [[nodiscard]] int of_source(std::size_t bin) const { return std::min(static_cast<int>(bin), source_bins_ - 1); }
  [[nodiscard]] int of_target(std::size_t bin) const {
    return source_bins_ + std::min(static_cast<int>(bin), target_bins_ - 1);
  }
  [[nodiscard]] SmallMotion about_origin(int number) const;
  using NumberOf = int (TimedMotions::*)(std::size_t bin) const;
  [[nodiscard]] Vector6 motion_of(const ShareOfTime& shares, NumberOf number_of) const;
  [[nodiscard]] Matrix6 form_of(const CommonPlace& place) const;
  void weigh(double scale_m);
  void add_steps(int first_bin, int bins, double step_m, Eigen::MatrixXd& information) const;

  PairGrain grain_;
  int source_bins_ = 1;
  int target_bins_ = 1;
  Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
  double radius_m_ = 1.0;                 // rotations times this are lengths
  std::vector<PlaneResidual> residuals_;  // by cell; their weights are what weigh() makes of planarities
  std::vector<double> planarity_;
  std::vector<std::uint32_t> patch_;
  std::size_t patches_ = 0;
  std::vector<Cell> cells_;
  Eigen::VectorXd motions_;  // of the source's bins, then of the target's; rotations times the radius
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

TimedMotions::TimedMotions(std::span<const PlaneResidual> residuals, const PairGrain& grain) : grain_(grain) {
  const TimesKnown known = times_known(residuals);
  if (known.source) source_bins_ = int{kTimeBins};
  if (known.target) target_bins_ = int{kTimeBins};
  for (const PlaneResidual& r : residuals) centre_m_ += r.point_m / static_cast<double>(residuals.size());
  radius_m_ = std::sqrt(std::max(scatter_about(residuals, centre_m_).trace(), grain.edge_m * grain.edge_m));
  motions_ = Eigen::VectorXd::Zero(6 * (source_bins_ + target_bins_));
  take(residuals);
}

void TimedMotions::take(std::span<const PlaneResidual> residuals) {
  const auto cell_of = [&](const PlaneResidual& r) {
    return static_cast<std::size_t>(of_source(time_bin(r.source_at)) * target_bins_ + of_target(time_bin(r.target_at)) -
                                    source_bins_);
  };
  cells_.clear();
  std::vector<std::size_t> firsts(static_cast<std::size_t>(source_bins_ * target_bins_) + 1, 0);
  for (const PlaneResidual& r : residuals) ++firsts[cell_of(r) + 1];
  for (std::size_t k = 1; k < firsts.size(); ++k) firsts[k] += firsts[k - 1];
  for (std::size_t k = 0; k + 1 < firsts.size(); ++k) {
    if (firsts[k] == firsts[k + 1]) continue;
    const int at = static_cast<int>(k);
    cells_.push_back({at / target_bins_, source_bins_ + at % target_bins_, firsts[k], firsts[k + 1]});
  }
  residuals_.resize(residuals.size());
  for (const PlaneResidual& r : residuals) residuals_[firsts[cell_of(r)]++] = r;
  planarity_.clear();
  for (const PlaneResidual& r : residuals_) planarity_.push_back(r.weight);
  patch_ = patch_numbers(residuals_, centre_m_, kPatch_m);
  patches_ = patch_.empty() ? 0 : *std::max_element(patch_.begin(), patch_.end()) + std::size_t{1};
}

SmallMotion TimedMotions::about_origin(int number) const {
  const Eigen::Vector3d turn_rad = motions_.segment<3>(6 * number + 3) / radius_m_;
  return {motions_.segment<3>(6 * number) - turn_rad.cross(centre_m_), turn_rad};
}

MotionsInTime TimedMotions::motions() const {
  MotionsInTime in_time;
  for (std::size_t bin = 0; bin < kTimeBins; ++bin) {
    in_time.source[bin] = about_origin(of_source(bin));
    in_time.target[bin] = about_origin(of_target(bin));
  }
  return in_time;
}

// What a place moves by, in the mean over when either submap saw it.
Vector6 TimedMotions::motion_of(const ShareOfTime& shares, NumberOf number_of) const {
  Vector6 motion = Vector6::Zero();
  for (std::size_t k = 0; k < kTimeBins; ++k) {
    motion += double{shares[k]} * motions_.segment<6>(6 * (this->*number_of)(k));
  }
  return motion;
}

// Of the square that a motion displaces it by. A place has an extent, so the form has an inverse even where all of them
// lie on a line.
Matrix6 TimedMotions::form_of(const CommonPlace& place) const {
  const Eigen::Vector3d arm = (place.point_m - centre_m_) / radius_m_;
  const double extent = std::pow(place_edge_m(grain_) / radius_m_, 2) / 12.0;
  return displacement_form(arm, arm * arm.transpose() + extent * Eigen::Matrix3d::Identity());
}

// A residual weighs what its patch knows, divided among all of the patch.
void TimedMotions::weigh(double scale_m) {
  std::vector<double> weights(patches_, 0.0);
  std::vector<double> squares_m2(patches_, 0.0);
  for (const Cell& cell : cells_) {
    Vector6 motion = motions_.segment<6>(6 * cell.source) - motions_.segment<6>(6 * cell.target);
    motion.tail<3>() /= radius_m_;
    for (std::size_t i = cell.first; i < cell.last; ++i) {
      PlaneResidual& r = residuals_[i];
      const double left_m = r.residual_m + change_of_residual(r, centre_m_, motion);
      r.weight = planarity_[i] * geman_mcclure(left_m, scale_m);
      weights[patch_[i]] += r.weight;
      squares_m2[patch_[i]] += r.weight * left_m * left_m;
    }
  }
  const double least_m = kLeastPatchVoxels * grain_.edge_m;
  std::vector<double> shares(patches_, 0.0);
  for (std::size_t k = 0; k < patches_; ++k) {
    if (weights[k] <= 0.0) continue;
    const double variance_m2 = kPatchShare * squares_m2[k] / weights[k] + least_m * least_m + grain_.variance_m2;
    shares[k] = std::min(1.0 / weights[k], 1.0 / kWholePatch) / variance_m2;
  }
  for (std::size_t i = 0; i < residuals_.size(); ++i) residuals_[i].weight *= shares[patch_[i]];
}

void TimedMotions::add_steps(int first_bin, int bins, double step_m, Eigen::MatrixXd& information) const {
  for (int bin = first_bin; bin + 1 < first_bin + bins; ++bin) {
    const Vector6 step = motions_.segment<6>(6 * (bin + 1)) - motions_.segment<6>(6 * bin);
    const double precision = 2.0 / (step_m * step_m + step.squaredNorm());
    for (int k = 6 * bin; k < 6 * bin + 6; ++k) {
      information(k, k) += precision;
      information(k + 6, k + 6) += precision;
      information(k + 6, k) -= precision;
    }
  }
}

void TimedMotions::improve(double scale_m) {
  const Eigen::Index unknowns = motions_.size();
  weigh(scale_m);
  Vector6 to_lengths = Vector6::Ones();
  to_lengths.tail<3>() /= radius_m_;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns);  // its lower triangle
  information.diagonal().setConstant(1.0 / (kTie_m * kTie_m));
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns);
  const SumJacobians sum_jacobians = sum_jacobians_with(vector_paths().back());
  for (const Cell& cell : cells_) {
    JacobianSums sums = sum_jacobians(std::span(residuals_).subspan(cell.first, cell.last - cell.first), centre_m_);
    sums.information = to_lengths.asDiagonal() * sums.information * to_lengths.asDiagonal();
    sums.gradient = sums.gradient.cwiseProduct(to_lengths);
    information.block<6, 6>(6 * cell.source, 6 * cell.source) += sums.information;
    information.block<6, 6>(6 * cell.target, 6 * cell.target) += sums.information;
    information.block<6, 6>(6 * cell.target, 6 * cell.source) -= sums.information;
    gradient.segment<6>(6 * cell.source) += sums.gradient;
    gradient.segment<6>(6 * cell.target) -= sums.gradient;
  }
  add_steps(0, source_bins_, kStepOfKernel * scale_m, information);
  add_steps(source_bins_, target_bins_, kStepOfKernel * scale_m, information);
  factor_.compute(information);
  motions_ = factor_.solve(-gradient);
}

Bend TimedMotions::bend(std::span<const CommonPlace> places) const {
  const auto count = static_cast<double>(places.size());
  SquareAboutMean all;
  SquareAboutMean by_source;
  SquareAboutMean by_target;
  for (const CommonPlace& place : places) {
    const Matrix6 form = form_of(place);
    const Vector6 source = motion_of(place.source, &TimedMotions::of_source);
    const Vector6 target = motion_of(place.target, &TimedMotions::of_target);
    by_source.add(form, source);
    by_target.add(form, target);
    all.add(form, source - target);
  }
  Vector6 common = all.common();
  double square = 0.0;
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(motions_.size());  // of the mean square
  for (const CommonPlace& place : places) {
    const Vector6 left =
        motion_of(place.source, &TimedMotions::of_source) - motion_of(place.target, &TimedMotions::of_target) - common;
    const Vector6 of_left = form_of(place) * left / count;
    square += left.dot(of_left);
    for (std::size_t k = 0; k < kTimeBins; ++k) {
      slope.segment<6>(6 * of_source(k)) += 2.0 * double{place.source[k]} * of_left;
      slope.segment<6>(6 * of_target(k)) -= 2.0 * double{place.target[k]} * of_left;
    }
  }
  Bend bend;
  bend.rms_m = std::sqrt(std::max(square, 0.0));
  const double scatter_m2 = 2.0 * kScatter * square;
  bend.variance_m4 = slope.dot(factor_.solve(slope)) + scatter_m2 * scatter_m2;
  bend.kind = by_source.left() >= by_target.left() ? BendKind::kSource : BendKind::kTarget;
  bend.parts = static_cast<int>(cells_.size());
  common.tail<3>() /= radius_m_;
  const double noise_m2 = std::pow(kNoiseVoxels * grain_.edge_m, 2) + grain_.variance_m2;
  bend.common = common;
  bend.noise_share = std::min(noise_m2 / std::max(square, noise_m2), 1.0);
  bend.centre_m = centre_m_;
  bend.places = moments_of(places);
  return bend;
}

}  // namespace

TimesKnown times_known(std::span<const PlaneResidual> residuals) {
  const auto differ = [&](std::uint8_t PlaneResidual::*seen_at) {
    return std::any_of(residuals.begin(), residuals.end(),
                       [&](const PlaneResidual& r) { return r.*seen_at != residuals.front().*seen_at; });
  };
  return {differ(&PlaneResidual::source_at), differ(&PlaneResidual::target_at)};
}

Bend bend_in_time(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m,
                  const PairInMotion& in_motion) {
  if (residuals.size() < kFewestResiduals) return {.places = moments_of(places_of(residuals, place_edge_m(grain)))};
  TimedMotions motions(residuals, grain);
  int last_rounds = 0;
  for (double scale_m = 0.5 * reach_m; last_rounds < kLastRounds; scale_m = std::max(scale_m * kShrink, grain.edge_m)) {
    last_rounds += scale_m <= grain.edge_m ? 1 : 0;
    motions.improve(scale_m);
  }
  for (int again = 0; in_motion.rematch && again < kRematches; ++again) {
    const MotionsInTime now = motions.motions();
    const auto shift = [&](const Eigen::Vector3d& at_m, std::uint8_t source_at,
                           std::uint8_t target_at) -> Eigen::Vector3d {
      return now.source[time_bin(source_at)].of(at_m) - now.target[time_bin(target_at)].of(at_m);
    };
    motions.take(in_motion.rematch(shift));
    for (int round = 0; round < kLastRounds; ++round) motions.improve(grain.edge_m);
  }
  std::vector<CommonPlace> places;
  if (in_motion.find_places) places = in_motion.find_places(motions.motions());
  if (places.size() < kFewestPlaces) places = motions.places();
  return motions.bend(places);
}

}  // namespace kilter
