// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

constexpr double kVoxel_m = 0.1;
const PairGrain kGrain = {.edge_m = kVoxel_m};
constexpr double kReach_m = 1.0;

// How far the source lies off from the target along +x and +y at a place, for what it saw at a time and the target at
// another (0..255).
using Displacement = std::function<Eigen::Vector2d(const Eigen::Vector3d& at_m, double source_at, double target_at)>;

// A hall of 24 by 10 m with walls on all sides and a floor; either submap saw every place at all times.
std::vector<PlaneResidual> hall(const Displacement& displacement, double noise_m) {
  Rng rng(7, 0);
  std::vector<PlaneResidual> residuals;
  const auto add = [&](const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal) {
    const auto source_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));
    const auto target_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));
    const Eigen::Vector2d moved_m = displacement(at_m, source_at, target_at);
    const double off_m = normal.head<2>().dot(moved_m) + noise_m * rng.normal();
    residuals.push_back({at_m, normal, off_m, 1.0, source_at, target_at});
  };
  for (int i = 0; i < 2400; ++i) {
    const double along_m = rng.uniform(0.0, 24.0);
    const double across_m = rng.uniform(0.0, 10.0);
    const double up_m = rng.uniform(0.0, 3.0);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    add({along_m, side > 0.0 ? 0.0 : 10.0, up_m}, {0.0, side, 0.0});
    add({side > 0.0 ? 0.0 : 24.0, across_m, up_m}, {side, 0.0, 0.0});
    add({along_m, across_m, 0.0}, {0.0, 0.0, 1.0});
  }
  return residuals;
}

// As octrees show it, and single scans: nobody knows when what was seen.
std::vector<PlaneResidual> without_times(std::vector<PlaneResidual> residuals) {
  for (PlaneResidual& r : residuals) r.source_at = r.target_at = 0;
  return residuals;
}

Eigen::Vector2d nowhere(const Eigen::Vector3d&, double, double) { return Eigen::Vector2d::Zero(); }

CommonPlace place_at(const Eigen::Vector3d& point_m, std::uint8_t source_at, std::uint8_t target_at) {
  CommonPlace place{.point_m = point_m};
  place.source[time_bin(source_at)] = 1.0F;
  place.target[time_bin(target_at)] = 1.0F;
  return place;
}

// Both saw every place once, whenever that was.
PairInMotion each_a_place(const std::vector<PlaneResidual>& residuals) {
  std::vector<CommonPlace> places;
  for (const PlaneResidual& r : residuals) places.push_back(place_at(r.point_m, r.source_at, r.target_at));
  PairInMotion in_motion;
  in_motion.find_places = [places](const MotionsInTime&) { return places; };
  return in_motion;
}

Bend bend_of(const std::vector<PlaneResidual>& residuals) {
  return measure_bend(residuals, kGrain, kReach_m, each_a_place(residuals));
}

Bend bend_of(const Displacement& displacement, double noise_m = 0.01) { return bend_of(hall(displacement, noise_m)); }

Bend bend_by_place(const Displacement& displacement, double noise_m = 0.01) {
  return measure_bend(without_times(hall(displacement, noise_m)), kGrain, kReach_m);
}

TEST(MeasureBend, AHallThatIsOneShowsNone) {
  EXPECT_LT(bend_of(nowhere, 0.02).rms_m, 0.008);  // 24 motions follow some of the noise
  EXPECT_LT(bend_by_place(nowhere, 0.02).rms_m, 0.005);
}

TEST(MeasureBend, AFarEndThatWasMovedCountsByItsShare) {
  const Bend bend = bend_by_place(
      [](const Eigen::Vector3d& at_m, double, double) { return Eigen::Vector2d(0.0, at_m.x() < 12.0 ? 0.0 : 0.3); });
  EXPECT_NEAR(bend.rms_m, 0.3 * std::sqrt(0.5), 0.03);
  EXPECT_EQ(bend.kind, BendKind::kSpace);
  EXPECT_GT(bend.variance_m4, 0.0);
  EXPECT_TRUE(bend.common.isZero(0.0));
}

TEST(MeasureBend, ASlipInsideTheSourceIsFoundByTimeAndNamed) {
  const Bend bend = bend_of([](const auto&, double source_at, double) {
    return source_at < 192.0 ? Eigen::Vector2d(0.0, 0.0) : Eigen::Vector2d(0.2, 0.2);
  });
  // A quarter lies 0.283 m off; the best rigid motion takes a quarter of that back.
  EXPECT_NEAR(bend.rms_m, std::sqrt(0.08 * 0.25 * 0.75), 0.01);
  EXPECT_EQ(bend.kind, BendKind::kSource);
  const Eigen::Vector2d at_middle_m =
      bend.common.head<2>() + bend.common.tail<3>().cross(Eigen::Vector3d(12.0, 5.0, 1.5) - bend.centre_m).head<2>();
  EXPECT_NEAR(at_middle_m.x(), -0.05, 0.01);
  EXPECT_NEAR(at_middle_m.y(), -0.05, 0.01);
}

TEST(MeasureBend, TheTargetIsNamedWhereItSlips) {
  const Bend bend = bend_of([](const auto&, double, double target_at) {
    return target_at < 64.0 ? Eigen::Vector2d(0.0, 0.15) : Eigen::Vector2d(0.0, 0.0);
  });
  EXPECT_NEAR(bend.rms_m, 0.15 * std::sqrt(0.25 * 0.75), 0.01);
  EXPECT_EQ(bend.kind, BendKind::kTarget);
}

// A few centimetres, which no part shows on its own: what either submap's time says of it adds up.
TEST(MeasureBend, BothDriftSlowlyAndAllOfItIsSeen) {
  const double drift_m = 0.06;  // from first to last, of each
  const Bend bend = bend_of([&](const auto&, double source_at, double target_at) {
    return Eigen::Vector2d(drift_m * source_at / 255.0, drift_m * target_at / 255.0);
  });
  // Uniform over a range: a twelfth of its square, twice.
  EXPECT_NEAR(bend.rms_m, drift_m * std::sqrt(2.0 / 12.0), 0.003);
  EXPECT_LT(std::sqrt(bend.variance_m4), 0.5 * bend.rms_m * bend.rms_m);
}

// The source slips by half a metre before its last twelfth. A place that it saw all the time is off by a twelfth of
// that in the mean, however many voxels the last scans drew of it, and one that it saw before not at all.
TEST(MeasureBend, APlaceThatWasSeenAllTheTimeIsOffByTheMean) {
  const double slip_m = 0.5;
  const std::vector<PlaneResidual> residuals = hall(
      [&](const auto&, double source_at, double) { return Eigen::Vector2d(0.0, source_at < 234.0 ? 0.0 : slip_m); },
      0.01);
  PairInMotion in_motion;
  in_motion.find_places = [&](const MotionsInTime&) {
    std::vector<CommonPlace> places;
    for (const PlaneResidual& r : residuals) {
      CommonPlace& place = places.emplace_back();
      place.point_m = r.point_m;
      place.source.fill(1.0F / kTimeBins);
      place.target.fill(1.0F / kTimeBins);
      if (places.size() % 2 == 0) continue;
      place.source.fill(1.0F / (kTimeBins - 1));
      place.source.back() = 0.0F;
    }
    return places;
  };
  EXPECT_GT(bend_of(residuals).rms_m, 0.1) << "else this shows nothing";
  EXPECT_NEAR(measure_bend(residuals, kGrain, kReach_m, in_motion).rms_m, slip_m / kTimeBins / 2.0, 0.002);
}

// A turn about the line would not move them.
TEST(MeasureBend, PlacesOnALineLeaveTheCommonMotionFinite) {
  const std::vector<PlaneResidual> residuals = hall(
      [](const auto&, double source_at, double) { return Eigen::Vector2d(0.0, source_at < 128.0 ? 0.0 : 0.2); }, 0.01);
  PairInMotion in_motion;
  in_motion.find_places = [&](const MotionsInTime&) {
    std::vector<CommonPlace> places;
    for (int i = 0; i < 80; ++i) {
      places.push_back(place_at({0.3 * i, 0.0, 1.0}, static_cast<std::uint8_t>(i % 2 == 0 ? 10 : 200), 0));
    }
    return places;
  };
  const Bend bend = measure_bend(residuals, kGrain, kReach_m, in_motion);
  EXPECT_NEAR(bend.rms_m, 0.1, 0.01);
  EXPECT_LT(bend.common.norm(), 0.2);
}

// The source turns while it goes. Far away it saw as many places as near by, in leaves that fix nothing and give no
// residuals: they are off by three times as much, and count.
TEST(MeasureBend, PlacesThatFixNothingCount) {
  const double turn_rad = 0.01;  // from first to last
  const auto turned = [&](const Eigen::Vector3d& at_m, double source_at, double) -> Eigen::Vector2d {
    return turn_rad * (source_at / 255.0) * Eigen::Vector2d(-at_m.y(), at_m.x());
  };
  const std::vector<PlaneResidual> residuals = hall(turned, 0.01);
  std::vector<CommonPlace> places;
  double near_m2 = 0.0;
  double all_m2 = 0.0;
  for (const PlaneResidual& r : residuals) {
    const Eigen::Vector3d leaf_m = r.point_m + Eigen::Vector3d(40.0, 0.0, 0.0);
    places.push_back(place_at(r.point_m, r.source_at, r.target_at));
    places.push_back(place_at(leaf_m, r.source_at, r.target_at));
    const double mean = 127.95;  // the pose that leaves the least turns by as much
    near_m2 += turned(r.point_m, r.source_at - mean, 0.0).squaredNorm() / static_cast<double>(residuals.size());
    all_m2 += turned(leaf_m, r.source_at - mean, 0.0).squaredNorm() / static_cast<double>(2 * residuals.size());
  }
  all_m2 += 0.5 * near_m2;
  PairInMotion in_motion;
  in_motion.find_places = [&](const MotionsInTime&) { return places; };
  EXPECT_NEAR(bend_of(residuals).rms_m, std::sqrt(near_m2), 0.1 * std::sqrt(near_m2));
  EXPECT_NEAR(measure_bend(residuals, kGrain, kReach_m, in_motion).rms_m, std::sqrt(all_m2), 0.1 * std::sqrt(all_m2));
  EXPECT_GT(all_m2, 4.0 * near_m2) << "else this shows nothing";
}

// In the second half of its time the source saw floor only: along it, it lies where it was last known to be.
TEST(MeasureBend, WhatSawOnlyFloorStaysWithItsNeighbours) {
  std::vector<PlaneResidual> residuals = hall(
      [](const auto&, double source_at, double) { return Eigen::Vector2d(source_at < 64.0 ? 0.0 : 0.1, 0.0); }, 0.01);
  std::erase_if(residuals, [](const PlaneResidual& r) { return r.source_at >= 128 && r.direction.z() == 0.0; });
  double share = 0.0;
  for (const PlaneResidual& r : residuals) {
    share += (r.source_at < 64 ? 1.0 : 0.0) / static_cast<double>(residuals.size());
  }
  EXPECT_NEAR(bend_of(residuals).rms_m, 0.1 * std::sqrt(share * (1.0 - share)), 0.01);
}

TEST(MeasureBend, TheOtherWayRoundItIsAsLarge) {
  const auto displacement = [](const Eigen::Vector3d& at_m, double source_at, double) {
    return Eigen::Vector2d(0.0, source_at < 100.0 ? 0.0 : 0.01 * at_m.x());
  };
  std::vector<PlaneResidual> residuals = hall(displacement, 0.01);
  const Bend forward = bend_of(residuals);
  for (PlaneResidual& r : residuals) {
    r.residual_m = -r.residual_m;
    std::swap(r.source_at, r.target_at);
  }
  const Bend backward = bend_of(residuals);
  EXPECT_NEAR(forward.rms_m, backward.rms_m, 1e-6);
  EXPECT_NEAR((forward.common + backward.common).norm(), 0.0, 1e-6);
  EXPECT_EQ(forward.kind, BendKind::kSource);
  EXPECT_EQ(backward.kind, BendKind::kTarget);
}

// What only one of the two saw: a third of all residuals, anywhere within reach, whenever.
TEST(MeasureBend, ClutterIsOutvotedInTime) {
  Rng rng(8, 0);
  std::vector<PlaneResidual> residuals = hall(nowhere, 0.01);
  for (PlaneResidual& r : residuals) {
    if (rng.uniform(0.0, 1.0) < 0.33) r.residual_m = rng.uniform(-1.0, 1.0);
  }
  EXPECT_LT(bend_of(residuals).rms_m, 0.02);
}

TEST(MeasureBend, OneThatKnowsNoTimesIsLookedAtByPlaceAsWell) {
  const auto far_end = [](const Eigen::Vector3d& at_m, double, double) {
    return Eigen::Vector2d(0.0, at_m.x() < 12.0 ? 0.0 : 0.3);
  };
  std::vector<PlaneResidual> residuals = hall(far_end, 0.01);
  for (PlaneResidual& r : residuals) r.target_at = 0;
  const Bend bend = bend_of(residuals);
  EXPECT_NEAR(bend.rms_m, 0.3 * std::sqrt(0.5), 0.03);
  EXPECT_EQ(bend.kind, BendKind::kSpace);
}

TEST(MeasureBend, ClutterOfAllSizesSaysNothing) {
  Rng rng(8, 0);
  std::vector<PlaneResidual> residuals = without_times(hall(nowhere, 0.01));
  for (PlaneResidual& r : residuals) {
    if (r.point_m.x() > 12.0) r.residual_m = rng.uniform(-1.0, 1.0);
  }
  EXPECT_LT(bend_of(residuals).rms_m, 0.02);
}

// Beyond the middle the two saw different surfaces: some fit where they are, twice as many happen to fit 0.3 m off.
TEST(MeasureBend, AMotionThatMakesLittleMoreFitIsHalfBelievedAndDoubted) {
  Rng rng(9, 0);
  std::vector<PlaneResidual> residuals = without_times(hall(nowhere, 0.01));
  for (PlaneResidual& r : residuals) {
    if (r.point_m.x() < 12.0 || r.direction.y() == 0.0) continue;
    r.residual_m = (rng.uniform(0.0, 1.0) < 2.0 / 3.0 ? 0.3 * r.direction.y() : 0.0) + 0.01 * rng.normal();
  }
  const Bend bend = bend_of(residuals);
  const double certain_m = 0.3 * std::sqrt(0.5);
  EXPECT_NEAR(bend.rms_m, certain_m * std::sqrt(0.5), 0.05);
  EXPECT_GT(std::sqrt(bend.variance_m4), 0.5 * bend.rms_m * bend.rms_m);
}

// Trunks of 24 cm: the plane that is near at the aligned pose is that of the side that happens to be near, and not of
// the side that the source saw.
TEST(MeasureBend, BetweenTrunksPlacesAreMatchedAnewWhereTheMotionsPutThem) {
  constexpr int kTrunks = 80;
  constexpr int kOfEach = 60;  // points, of either submap
  constexpr double kRadius_m = 0.12;
  constexpr double kDrift_m = 0.4;  // from first to last
  struct Seen {
    Eigen::Vector3d at_m;
    Eigen::Vector3d normal;
    std::uint8_t source_at;
    std::uint8_t target_at;
    int trunk;
  };
  Rng rng(14, 0);
  std::vector<Seen> source;
  std::vector<Seen> target;
  for (int trunk = 0; trunk < kTrunks; ++trunk) {
    const Eigen::Vector3d middle_m(0.5 * trunk, rng.uniform(-8.0, 8.0), 0.0);
    const auto source_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));  // to and fro between them
    for (int i = 0; i < kOfEach; ++i) {
      const auto target_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));
      for (std::vector<Seen>* of : {&source, &target}) {
        const double angle = rng.uniform(-M_PI, M_PI);
        const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
        Eigen::Vector3d at_m = middle_m + kRadius_m * normal;
        at_m.z() = rng.uniform(0.0, 0.2);
        if (of == &source) at_m.y() -= kDrift_m * (source_at / 255.0 - 0.5);
        of->push_back({at_m, normal, source_at, target_at, trunk});
      }
    }
  }
  const auto nearest = [&](const Seen& from, const Eigen::Vector3d& at_m) {
    const auto first = target.begin() + from.trunk * kOfEach;
    return std::min_element(first, first + kOfEach, [&](const Seen& a, const Seen& b) {
      return (a.at_m - at_m).squaredNorm() < (b.at_m - at_m).squaredNorm();
    });
  };
  const auto match = [&](const MotionOfPlace& shift) {
    std::vector<PlaneResidual> residuals;
    for (const Seen& from : source) {
      auto plane = nearest(from, from.at_m);
      if (shift) plane = nearest(from, from.at_m + shift(from.at_m, from.source_at, plane->target_at));
      if (plane->normal.dot(from.normal) < 0.6) continue;
      residuals.push_back({from.at_m, plane->normal, plane->normal.dot(from.at_m - plane->at_m), 1.0, from.source_at,
                           plane->target_at});
    }
    return residuals;
  };
  const double true_m = kDrift_m / std::sqrt(12.0);
  const double once_m = bend_of(match({})).rms_m;
  PairInMotion in_motion;
  in_motion.rematch = match;
  in_motion.find_places = [&](const MotionsInTime& motions) {
    return each_a_place(match([&](const Eigen::Vector3d& at_m, std::uint8_t source_at,
                                  std::uint8_t target_at) -> Eigen::Vector3d {
             return motions.source[time_bin(source_at)].of(at_m) - motions.target[time_bin(target_at)].of(at_m);
           }))
        .find_places(motions);
  };
  const double anew_m = measure_bend(match({}), kGrain, kReach_m, in_motion).rms_m;
  EXPECT_LT(once_m, 0.9 * true_m) << "else this shows nothing";
  EXPECT_NEAR(anew_m, true_m, 0.02 * true_m);
}

TEST(MeasureBend, NothingIsNoBend) {
  EXPECT_EQ(measure_bend({}, kGrain, kReach_m).rms_m, 0.0);
  EXPECT_EQ(measure_bend({}, kGrain, kReach_m).parts, 0);
}

}  // namespace
}  // namespace kilter
