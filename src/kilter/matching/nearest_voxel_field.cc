// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <numbers>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

constexpr int kMostReach = 24;
constexpr double kMostBlocks = 1 << 22;
constexpr int kMostWidth = kBlockSize + 2 * kMostReach;  // of the window of cells that a block's answers lie in
constexpr int kMostRing = (kMostReach + kBlockSize - 1) / kBlockSize;
constexpr int kMostAround = 2 * kMostRing + 1;

// A voxel of the window and how far it is: the square above, then z, y and x. The least one is the answer.
constexpr int kAxisBits = 6;
constexpr int kSquareShift = 3 * kAxisBits;
constexpr std::int32_t kAxisMask = (1 << kAxisBits) - 1;
constexpr std::int32_t kFar = 1 << 30;  // no sum of squares lifts it over the sign or brings it within reach
static_assert(kMostWidth <= 1 << kAxisBits);
static_assert(2 * kMostReach * kMostReach < (1 << (30 - kSquareShift)));

using Row = std::int32_t __attribute__((vector_size(kBlockSize * sizeof(std::int32_t))));  // the cells of one y and z

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

// The occupied cells around a block. Large, and filled in part only: what is not said to be filled is not read. All of
// it becomes part of each kernel, for the sake of its instructions.
struct Window {
  [[gnu::always_inline]] inline Window(const VoxelMap& map, const Eigen::Vector3i& middle, int reach_in_cells);

  int reach;
  int ring;  // blocks on each side
  bool empty = true;
  // Of the blocks around the middle one, x fastest: what is occupied and the number of each layer's first voxel. Filled
  // where there is such a voxel.
  struct Around {
    const VoxelBlock* block;
    std::array<std::uint32_t, kBlockSize> first_voxel;
  };
  std::array<Around, kMostAround * kMostAround * kMostAround> blocks;
  // A bit for each cell, a word for each row of them; cell (reach, reach, reach) is the block's first. Filled up to the
  // width.
  std::array<std::array<std::uint64_t, kMostWidth>, kMostWidth> rows;

  [[nodiscard]] int width() const { return kBlockSize + 2 * reach; }
  [[nodiscard]] int around() const { return 2 * ring + 1; }

 private:
  [[gnu::always_inline]] inline void add(const VoxelBlock& block, const Eigen::Vector3i& offset, Around& around);
};

// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): zeros that nobody reads cost more than the filling
Window::Window(const VoxelMap& map, const Eigen::Vector3i& middle, int reach_in_cells)
    : reach(reach_in_cells), ring((reach_in_cells + kBlockSize - 1) / kBlockSize) {
  const auto used = static_cast<std::size_t>(width());
  for (std::size_t z = 0; z < used; ++z) std::fill_n(rows[z].begin(), used, 0);
  std::size_t number = 0;
  for (int z = -ring; z <= ring; ++z) {
    for (int y = -ring; y <= ring; ++y) {
      for (int x = -ring; x <= ring; ++x, ++number) {
        const std::int32_t found = map.find_block(middle + Eigen::Vector3i(x, y, z));
        if (found == BlockIndex::kNone) continue;
        const VoxelBlock& block = map.blocks()[static_cast<std::size_t>(found)];
        if (block.voxel_count > 0) add(block, {x, y, z}, blocks[number]);
      }
    }
  }
}

void Window::add(const VoxelBlock& block, const Eigen::Vector3i& offset, Around& around) {
  const Eigen::Vector3i first = offset * kBlockSize + Eigen::Vector3i::Constant(reach);
  const std::uint64_t inside = width() == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width()) - 1;
  empty = false;
  around.block = &block;
  std::uint32_t voxel = block.first_voxel;
  for (int z = 0; z < kBlockSize; ++z) {
    const std::uint64_t layer = block.occupied[static_cast<std::size_t>(z)];
    around.first_voxel[static_cast<std::size_t>(z)] = voxel;
    voxel += static_cast<std::uint32_t>(std::popcount(layer));
    const int to = first.z() + z;
    if (layer == 0 || to < 0 || to >= width()) continue;
    for (int y = std::max(0, -first.y()); y < std::min(kBlockSize, width() - first.y()); ++y) {
      const std::uint64_t bits = layer >> (8 * y) & 0xFF;
      const std::uint64_t moved = first.x() >= 0 ? bits << first.x() : bits >> -first.x();
      const int row = first.y() + y;
      rows[static_cast<std::size_t>(to)][static_cast<std::size_t>(row)] |= moved & inside;
    }
  }
}

// Of eight cells in a row, some of which are occupied: where the nearest one is that is not to the right of each, or
// not to its left; kNoCell where there is none.
struct NearestOfEight {
  static constexpr std::int8_t kNoCell = 127;
  using Cells = std::int8_t __attribute__((vector_size(kBlockSize)));
  using All = std::array<std::array<std::int8_t, kBlockSize>, 1 << kBlockSize>;
  All left{};   // -kNoCell for none
  All right{};  // kNoCell for none
};

constexpr NearestOfEight kNearestOfEight = [] {
  NearestOfEight nearest;
  for (std::size_t bits = 0; bits < nearest.left.size(); ++bits) {
    std::int8_t left = -NearestOfEight::kNoCell;
    std::int8_t right = NearestOfEight::kNoCell;
    for (std::int8_t x = 0; x < kBlockSize; ++x) {
      const auto from_end = static_cast<std::int8_t>(kBlockSize - 1 - x);
      if ((bits >> x & 1) != 0) left = x;
      if ((bits >> from_end & 1) != 0) right = from_end;
      nearest.left[bits][static_cast<std::size_t>(x)] = left;
      nearest.right[bits][static_cast<std::size_t>(from_end)] = right;
    }
  }
  return nearest;
}();

[[gnu::always_inline]] inline void widen(const std::array<std::int8_t, kBlockSize>& cells, Row& row) {
  NearestOfEight::Cells bytes;
  std::memcpy(&bytes, cells.data(), sizeof(bytes));
  row = __builtin_convertvector(bytes, Row);
}

// The nearest occupied cell of one row for each cell of the block's eight columns; the left one of two.
[[gnu::always_inline]] inline void nearest_in_row(std::uint64_t bits, int reach, Row& row) {
  const std::uint64_t before = bits & ((std::uint64_t{1} << reach) - 1);
  const std::uint64_t behind = bits >> reach >> kBlockSize;
  const auto inside = static_cast<std::size_t>(bits >> reach & ((1U << kBlockSize) - 1));
  const int last_before = before == 0 ? -NearestOfEight::kNoCell : 63 - std::countl_zero(before) - reach;
  const int first_behind = behind == 0 ? NearestOfEight::kNoCell : kBlockSize + std::countr_zero(behind);
  Row left;
  Row right;
  widen(kNearestOfEight.left[inside], left);
  widen(kNearestOfEight.right[inside], right);
  left = left > last_before ? left : Row{} + last_before;
  right = right < first_behind ? right : Row{} + first_behind;
  constexpr Row kColumns = {0, 1, 2, 3, 4, 5, 6, 7};
  const Row to_left = kColumns - left;
  const Row to_right = right - kColumns;
  const Row nearest = to_left <= to_right ? left : right;
  const Row off = to_left <= to_right ? to_left : to_right;
  const Row key = off * off << kSquareShift | (nearest + reach);
  row = off <= reach ? key : Row{} + kFar;
}

using Layer = std::array<Row, kBlockSize>;  // the cells of one z
using Keys = std::array<Layer, kBlockSize>;

// What being so many cells off along one axis adds to each key of a row, for all that a cell of the block and one of
// the window can be.
constexpr int kMostOff = kMostReach + kBlockSize - 1;
constexpr auto kLifts = [] {
  std::array<std::array<std::int32_t, kBlockSize>, 2 * kMostOff + 1> lifts{};
  int off = -kMostOff;
  for (auto& lift : lifts) {
    lift.fill(off * off << kSquareShift);
    ++off;
  }
  return lifts;
}();
static_assert(std::int64_t{kFar} + 2 * (std::int64_t{kMostOff * kMostOff} << kSquareShift) < INT32_MAX);

// Rows that stand `off`, off - 1, off - 2 ... cells off take over what is nearer.
[[gnu::always_inline]] inline void lift_into(const Row& row, int off, Row* first, std::size_t stride) {
  for (std::size_t to = 0; to < kBlockSize; ++to) {
    Row lifted;
    std::memcpy(&lifted, kLifts[static_cast<std::size_t>(off + kMostOff) - to].data(), sizeof(lifted));
    lifted += row;
    Row& least = first[to * stride];
    least = lifted < least ? lifted : least;
  }
}

// A separable transform: along x, then y, then z. Integers, so that every processor finds the same. What is beyond
// reach along one axis is so altogether.
[[gnu::always_inline]] inline void transform(const Window& window, Keys& keys) {
  const int reach = window.reach;
  for (Layer& layer : keys) layer.fill(Row{} + kFar);
  for (int z = 0; z < window.width(); ++z) {
    Layer layer;
    layer.fill(Row{} + kFar);
    bool any = false;
    for (int y = 0; y < window.width(); ++y) {
      const std::uint64_t bits = window.rows[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)];
      if (bits == 0) continue;
      any = true;
      Row in_row;
      nearest_in_row(bits, reach, in_row);
      lift_into(in_row + (y << kAxisBits), y - reach, layer.data(), 1);
    }
    if (!any) continue;
    for (std::size_t y = 0; y < kBlockSize; ++y) {
      lift_into(layer[y] + (z << (2 * kAxisBits)), z - reach, keys[0].data() + y, kBlockSize);
    }
  }
}

// The voxels that a row of keys names, or kNoVoxel.
[[gnu::always_inline]] inline void voxels_of_keys(const Window& window, const Row& keys, std::uint32_t* voxels) {
  // From the first cell of the first block around.
  const int shift = window.ring * kBlockSize - window.reach;
  const Row x = (keys & kAxisMask) + shift;
  const Row y = (keys >> kAxisBits & kAxisMask) + shift;
  const Row z = (keys >> (2 * kAxisBits) & kAxisMask) + shift;
  const int around = window.around();
  constexpr int kInside = kBlockSize - 1;
  const Row numbers = ((z >> kBlockShift) * around + (y >> kBlockShift)) * around + (x >> kBlockShift);
  const Row layers = z & kInside;
  const Row bits = (x & kInside) | (y & kInside) << kBlockShift;
  const Row squares = keys >> kSquareShift;
  for (std::size_t i = 0; i < kBlockSize; ++i) {
    voxels[i] = kNoVoxel;
    if (squares[i] > window.reach * window.reach) continue;
    const Window::Around& in = window.blocks[static_cast<std::size_t>(numbers[i])];
    const auto layer = static_cast<std::size_t>(layers[i]);
    const std::uint64_t below = (std::uint64_t{1} << bits[i]) - 1;
    voxels[i] = in.first_voxel[layer] + static_cast<std::uint32_t>(std::popcount(in.block->occupied[layer] & below));
  }
}

using Voxels = std::array<std::uint32_t, kBlockVoxels>;

// The answers of the block `middle`. \return false, and none, if nothing is near any of it.
[[gnu::always_inline]] inline bool compute(const VoxelMap& map, const Eigen::Vector3i& middle, int reach,
                                           Voxels& voxels) {
  const Window window(map, middle, reach);
  if (window.empty) return false;
  Keys keys;
  transform(window, keys);
  std::uint32_t* to = voxels.data();
  for (const Layer& layer : keys) {
    for (const Row& row : layer) {
      voxels_of_keys(window, row, to);
      to += kBlockSize;
    }
  }
  return true;
}

bool compute_baseline(const VoxelMap& map, const Eigen::Vector3i& middle, int reach, Voxels& voxels) {
  return compute(map, middle, reach, voxels);
}

#if defined(__x86_64__)
[[gnu::target("avx2,popcnt,lzcnt,bmi")]] bool compute_avx2(const VoxelMap& map, const Eigen::Vector3i& middle,
                                                           int reach, Voxels& voxels) {
  return compute(map, middle, reach, voxels);
}
#endif

using Compute = bool (*)(const VoxelMap& map, const Eigen::Vector3i& middle, int reach, Voxels& voxels);

Compute compute_with(VectorPath path) {
#if defined(__x86_64__)
  if (path != VectorPath::kBaseline) return compute_avx2;
#else
  static_cast<void>(path);
#endif
  return compute_baseline;
}

}  // namespace

bool NearestVoxelField::fits(const VoxelMap& map, double reach_m) {
  const int reach = reach_in_cells(reach_m, map.resolution_m());
  return reach <= kMostReach &&
         (map.bounds_m().isEmpty() || blocks_within(map, reach).size.cast<double>().prod() <= kMostBlocks);
}

NearestVoxelField::NearestVoxelField(const VoxelMap& map, double reach_m, VectorPath path)
    : map_(&map), reach_(reach_in_cells(reach_m, map.resolution_m())), path_(path) {
  KILTER_EXPECTS(fits(map, reach_m));
  if (map.bounds_m().isEmpty()) return;
  box_ = blocks_within(map, reach_);
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
  static const Block kNothingNear = [] {
    Block block{};
    block.voxels.fill(kNoVoxel);
    return block;
  }();
  const std::atomic_ref<const FieldCell*> place(table_[static_cast<std::size_t>(slot)]);
  if (const FieldCell* built = place.load(std::memory_order_acquire); built != nullptr) return built;
  const Eigen::Vector3i& size = box_.size;
  const Eigen::Vector3i at(slot % size.x(), slot / size.x() % size.y(), slot / (size.x() * size.y()));
  auto built = std::make_unique_for_overwrite<Block>();
  if (!compute_with(path_)(*map_, box_.low + at, reach_, built->voxels)) built.reset();
  const std::lock_guard lock(building_);
  if (const FieldCell* others = place.load(std::memory_order_relaxed); others != nullptr) return others;
  const Block* block = &kNothingNear;
  if (built) {
    block = built.get();
    blocks_.push_back(std::move(built));
  }
  place.store(block->voxels.data(), std::memory_order_release);
  return block->voxels.data();
}

std::size_t NearestVoxelField::bytes() const {
  const std::lock_guard lock(building_);
  constexpr std::size_t kOfAllocation = 16;
  constexpr std::size_t kPage = 4096;
  const std::size_t table = static_cast<std::size_t>(box_.size.cast<std::int64_t>().prod()) * kSlotBytes;
  return std::min(table, kPage * (blocks_.size() + 1)) +
         blocks_.size() * (sizeof(Block) + kOfAllocation + sizeof(blocks_.front()));
}

}  // namespace kilter
