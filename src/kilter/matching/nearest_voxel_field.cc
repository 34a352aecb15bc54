// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <numbers>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

constexpr double kMostBlocks = 1 << 22;

// The cells of a point's and of its voxel's centre may be this much farther apart than the two.
int reach_in_cells(double reach_m, double resolution_m) {
  return static_cast<int>(std::ceil(reach_m / resolution_m + std::numbers::sqrt3));
}

// Blocks of the lattice that hold cells within reach of an occupied voxel, at least.
FieldBox blocks_within(const VoxelMap& map, int reach) {
  const double resolution_m = map.resolution_m();
  const Eigen::Vector3i first = (map.bounds_m().min() / resolution_m).array().round().matrix().cast<int>();
  const Eigen::Vector3i end = (map.bounds_m().max() / resolution_m).array().round().matrix().cast<int>();
  const Eigen::Vector3i low = block_of(first - Eigen::Vector3i::Constant(reach));
  const Eigen::Vector3i high = block_of(end + Eigen::Vector3i::Constant(reach - 1));
  return {low, high - low + Eigen::Vector3i::Ones()};
}

}  // namespace

bool NearestVoxelField::fits(const VoxelMap& map, double reach_m) {
  const int reach = reach_in_cells(reach_m, map.resolution_m());
  return reach <= kMostFieldReach &&
         (map.bounds_m().isEmpty() || blocks_within(map, reach).size.cast<double>().prod() <= kMostBlocks);
}

NearestVoxelField::NearestVoxelField(const VoxelMap& map, double reach_m, VectorPath path)
    : map_(&map), reach_(reach_in_cells(reach_m, map.resolution_m())), path_(path) {
  KILTER_EXPECTS(fits(map, reach_m));
  if (map.bounds_m().isEmpty()) return;
  box_ = blocks_within(map, reach_);
  occupied_ = OccupiedBlocks(map, box_);
  // Zeros that the system makes when they are touched; a vector would touch them all.
  // NOLINTNEXTLINE(cppcoreguidelines-no-malloc)
  void* zeros = std::calloc(static_cast<std::size_t>(box_.size.cast<double>().prod()), kSlotBytes);
  table_.reset(static_cast<const FieldCell**>(zeros));
  if (table_ == nullptr) throw std::bad_alloc();
}

std::uint32_t NearestVoxelField::near(const Eigen::Vector3d& point_m) const { return *where(point_m); }

const std::uint32_t* NearestVoxelField::where(const Eigen::Vector3d& point_m) const {
  PointColumns alone;
  alone.set(0, point_m);
  CellPlaces places{};
  find_places(alone, 1, places);
  return places.slot[0] == CellPlaces::kOutside ? &kNoVoxel : build(places.slot[0]) + places.bit[0];
}

void NearestVoxelField::near(const PointColumns& points_m, std::size_t count, VoxelColumn& voxels) const {
  CellPlaces places;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as far as it is read
  find_places(points_m, count, places);
  const LookUpKernels& kernels = look_up_kernels(path_);
  for (std::size_t first = 0; first < count; first += LookUpKernels::kTogether) {
    while (std::uint32_t missing = kernels.read_cells(table_.get(), places, first, voxels)) {
      for (; missing != 0; missing &= missing - 1) {
        build(places.slot[first + static_cast<std::size_t>(std::countr_zero(missing))]);
      }
    }
  }
}

void NearestVoxelField::find_places(const PointColumns& points_m, std::size_t count, CellPlaces& places) const {
  look_up_kernels(path_).find_places(points_m, count, 1.0 / map_->resolution_m(), box_, places);
  for (std::size_t k = count; k % LookUpKernels::kTogether != 0; ++k) places.slot[k] = CellPlaces::kOutside;
}

// Or finds it built.
const FieldCell* NearestVoxelField::build(std::int32_t slot) const {
  static const FieldBlock kNothingNear = [] {
    FieldBlock block{};
    block.fill(kNoVoxel);
    return block;
  }();
  const std::atomic_ref<const FieldCell*> place(table_[static_cast<std::size_t>(slot)]);
  if (const FieldCell* built = place.load(std::memory_order_acquire); built != nullptr) return built;
  const Eigen::Vector3i& size = box_.size;
  const Eigen::Vector3i at(slot % size.x(), slot / size.x() % size.y(), slot / (size.x() * size.y()));
  auto built = std::make_unique_for_overwrite<FieldBlock>();
  if (!compute_field_block(*map_, occupied_, box_, at, reach_, path_, *built)) built.reset();
  const std::lock_guard lock(building_);
  if (const FieldCell* others = place.load(std::memory_order_relaxed); others != nullptr) return others;
  const FieldBlock* block = &kNothingNear;
  ++touched_;
  if (built) {
    block = built.get();
    blocks_.push_back(std::move(built));
  }
  place.store(block->data(), std::memory_order_release);
  return block->data();
}

std::size_t NearestVoxelField::bytes() const {
  const std::lock_guard lock(building_);
  constexpr std::size_t kOfAllocation = 16;
  constexpr std::size_t kPage = 4096;
  const std::size_t table = static_cast<std::size_t>(box_.size.cast<std::int64_t>().prod()) * kSlotBytes;
  return occupied_.bytes() + std::min(table, kPage * (touched_ + 1)) +
         blocks_.size() * (sizeof(FieldBlock) + kOfAllocation + sizeof(blocks_.front()));
}

}  // namespace kilter
