// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "methods.h"

#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "kilter/matching/nearest_of_all.h"
#include "kilter/matching/nearest_voxel.h"

namespace kilter {
namespace {

NearestVoxelSearch search_of(const Side& side) { return {side.map, VoxelPosition::kCentroid, kLimit_m}; }

}  // namespace

Method all_together(const Side& source, const Side& target) {
  using Searches = std::pair<NearestVoxelSearch, NearestVoxelSearch>;
  return {"kilter", [&, state = std::make_shared<std::unique_ptr<Searches>>()](
                        std::span<const Pose3> poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<Searches>(search_of(source), search_of(target));
            std::vector<NearestVoxel> found(source.points_m.size(), NearestVoxel{kNoVoxel, 0.0});
            for (const Pose3& pose : poses) {
              nearest_of_all_again((*state)->first, (*state)->second, pose, kLimit_m, found);
              for (std::size_t i = 0; i < found.size(); ++i) {
                distances_m[i] = found[i].voxel == kNoVoxel ? kNone : static_cast<float>(found[i].distance_m);
              }
            }
          }};
}

Method one_by_one(const Side& source, const Side& target) {
  struct State {
    NearestVoxelSearch search;
    NearestVoxelCursor cursor{search};
    explicit State(const Side& side) : search(search_of(side)) {}
  };
  return {"kilter, one by one", [&, state = std::make_shared<std::unique_ptr<State>>()](
                                    std::span<const Pose3> poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(target);
            std::vector<std::uint32_t> last(source.points_m.size(), kNoVoxel);
            for (const Pose3& pose : poses) {
              const Eigen::Isometry3d T = pose.isometry();
              for (std::size_t i = 0; i < source.points_m.size(); ++i) {
                const auto found = (*state)->cursor.nearest(moved(T, source.points_m[i]), kLimit_m, last[i]);
                distances_m[i] = found ? static_cast<float>(found->distance_m) : kNone;
                if (found) last[i] = found->voxel;
              }
            }
          }};
}

Method by_field(const Side& source, const Side& target) {
  struct State {
    NearestVoxelSearch search;
    RepeatedSearch repeated;
    State(const Side& from, const Side& onto) : search(search_of(onto)), repeated(search, from.points_m.size()) {}
  };
  return {"kilter, field", [&, state = std::make_shared<std::unique_ptr<State>>()](
                               std::span<const Pose3> poses, std::vector<float>& distances_m, bool build) {
            if (build || !*state) *state = std::make_unique<State>(source, target);
            std::vector<std::uint32_t> numbers(source.points_m.size());
            std::iota(numbers.begin(), numbers.end(), 0U);
            const LookUpKernels& kernels = look_up_kernels((*state)->search.path());
            FloatColumns from_m;
            PointColumns at_m;
            RepeatedSearch::Found found;
            for (const Pose3& pose : poses) {
              const Transform T(pose.isometry());
              for (std::size_t first = 0; first < numbers.size(); first += PointColumns::kMost) {
                const auto batch =
                    std::span(numbers).subspan(first, std::min(PointColumns::kMost, numbers.size() - first));
                for (std::size_t k = 0; k < batch.size(); ++k) from_m.set(k, source.points_m[first + k]);
                kernels.move(T, from_m, batch.size(), at_m);
                (*state)->repeated.near(batch, at_m, kLimit_m, found);
                for (std::size_t k = 0; k < batch.size(); ++k) {
                  distances_m[first + k] =
                      found.voxel[k] == kNoVoxel ? kNone : std::sqrt(static_cast<float>(found.square_m2[k]));
                }
              }
            }
          }};
}

}  // namespace kilter
