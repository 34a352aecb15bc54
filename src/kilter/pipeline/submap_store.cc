// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/submap_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "kilter/base/contract.h"
#include "kilter/occupancy/voxel_map_bytes.h"

namespace kilter {
namespace {

// Freed pages are given back whenever this part of the limit has been put out.
constexpr std::size_t kTrimShare = 8;

// Submaps that come and go leave holes in the heap, which the next ones, of other sizes, do not fill.
void give_pages_back() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::size_t number_of(SubmapId id) { return static_cast<std::size_t>(id.value); }

bool holds(std::span<const std::size_t> numbers, std::size_t number) {
  return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

// The spill space's own words, said of what they mean here. A full disk stays one.
Error spill_error(Error error) {
  error.message = "submaps that --memory leaves no room for: " + error.message;
  error.hint = "raise --memory, or let TMPDIR name a folder with more room";
  if (error.code != ErrorCode::kNoSpace) error.code = ErrorCode::kOutOfMemory;
  return error;
}

Error no_memory() {
  return {ErrorCode::kOutOfMemory, "the machine has no memory left for a submap", {}, "lower --memory or --jobs"};
}

}  // namespace

Error exceeds_memory(const std::string& what_needs, std::size_t needed_bytes, std::size_t allowed_bytes) {
  const auto hundredths = [](std::size_t bytes) { return static_cast<double>(bytes) / 1e4; };  // of a megabyte
  return {ErrorCode::kOutOfMemory,
          fmt::format("{} {:.2f} MB, more than --memory allows ({:.2f} MB)", what_needs,
                      std::ceil(hundredths(needed_bytes)) / 100.0, std::floor(hundredths(allowed_bytes)) / 100.0),
          {},
          "raise --memory, or use a coarser resolution or a smaller max_range"};
}

PinnedMap::~PinnedMap() {
  if (store_ != nullptr) store_->release(number_of(id_));
}

SubmapStore::SubmapStore(std::size_t count, const SearchSetup& setup, const StoreLimits& limits)
    : setup_(setup), limits_(limits), entries_(count), no_memory_(no_memory()) {
  for (std::size_t number = 0; number < count; ++number) {
    entries_[number].place = others_.insert(others_.end(), number);
  }
}

bool SubmapStore::fits(std::size_t needed) const {
  return limits_.memory_bytes == 0 || used_bytes_ + needed <= limits_.memory_bytes;
}

Error SubmapStore::too_large(std::size_t needed) const {
  return exceeds_memory("submaps that must be in memory together need at least", needed, limits_.memory_bytes);
}

void SubmapStore::fail_all(Error error) {
  if (!failure_) failure_ = std::move(error);
  changed_.notify_all();
}

Expected<void> SubmapStore::add(SubmapId id, VoxelMap map) {
  auto searchable = std::make_unique<const SearchableMap>(std::move(map), setup_);
  const std::size_t bytes = searchable->bytes();
  Lock lock(mutex_);
  while (true) {
    const Expected<bool> room = make_room(lock, bytes, {});
    if (!room) return pass_up(room.error());
    if (*room) break;
  }
  Entry& entry = entries_[number_of(id)];
  KILTER_EXPECTS(entry.map == nullptr && !entry.spilled);
  entry.map = std::move(searchable);
  entry.bytes = entry.fresh_bytes = bytes;
  used_bytes_ += bytes;
  keep_unused(entry);
  return {};
}

Expected<PinnedMap> SubmapStore::pin(SubmapId id) {
  const std::array numbers = {number_of(id)};
  if (const Expected<void> held = acquire(numbers); !held) return pass_up(held.error());
  return PinnedMap(*this, id, *entries_[numbers[0]].map);
}

Expected<PinnedPair> SubmapStore::pin(PairId pair) {
  const std::array numbers = {number_of(pair.source), number_of(pair.target)};
  if (const Expected<void> held = acquire(numbers); !held) return pass_up(held.error());
  return PinnedPair{PinnedMap(*this, pair.source, *entries_[numbers[0]].map),
                    PinnedMap(*this, pair.target, *entries_[numbers[1]].map)};
}

// All or nothing: a thread that held one of a pair while it waited for the other could wait for ever.
Expected<void> SubmapStore::acquire(std::span<const std::size_t> numbers) {
  std::vector<std::size_t> missing;
  missing.reserve(numbers.size());  // nothing may fail between the promise to bring a map and bringing it
  Lock lock(mutex_);
  while (true) {
    std::size_t needed = 0;
    bool going = false;
    for (const std::size_t number : numbers) {
      const Entry& entry = entries_[number];
      going = going || entry.going;
      if (entry.map == nullptr && !entry.coming) needed += entry.bytes;
    }
    if (going && !failure_) {
      changed_.wait(lock);
      continue;
    }
    const Expected<bool> room = make_room(lock, needed, numbers);
    if (!room) return pass_up(room.error());
    if (*room) break;
  }
  for (const std::size_t number : numbers) {
    Entry& entry = entries_[number];
    if (entry.map != nullptr && entry.pins == 0) take_unused(entry);
    ++entry.pins;
    ++in_use_;
    if (entry.map != nullptr || entry.coming) continue;
    entry.coming = true;
    used_bytes_ += entry.bytes;
    missing.push_back(number);
  }
  for (const std::size_t number : missing) bring_in(lock, number);
  changed_.wait(lock, [&] {
    return failure_ || std::all_of(numbers.begin(), numbers.end(),
                                   [&](std::size_t number) { return entries_[number].map != nullptr; });
  });
  if (failure_) return pass_up(*failure_);
  return {};
}

void SubmapStore::release(std::size_t number) {
  const Lock lock(mutex_);
  Entry& entry = entries_[number];
  --in_use_;
  if (--entry.pins == 0) {
    keep_unused(entry);
    // Searches may have grown while they were asked.
    const std::size_t bytes = entry.map->bytes();
    used_bytes_ += bytes - entry.bytes;
    entry.bytes = bytes;
  }
  changed_.notify_all();
}

Expected<bool> SubmapStore::make_room(Lock& lock, std::size_t needed, std::span<const std::size_t> kept) {
  if (failure_) return pass_up(*failure_);
  if (fits(needed)) return true;
  const auto victim =
      std::find_if(unused_.begin(), unused_.end(), [&](std::size_t number) { return !holds(kept, number); });
  if (victim != unused_.end()) {
    put_out(lock, *victim, needed);
  } else if (needed == 0) {
    return true;  // what is over the limit is in use
  } else if (in_use_ > 0) {
    changed_.wait(lock);
  } else if (!unused_.empty()) {
    // It has grown since it came, and fits beside the other one when it comes again.
    put_out(lock, unused_.front(), needed);
  } else {
    fail_all(too_large(needed));
  }
  return false;
}

void SubmapStore::put_out(Lock& lock, std::size_t number, std::size_t needed) {
  Entry& entry = entries_[number];
  if (!entry.spilled && limits_.spill == nullptr) return fail_all(too_large(used_bytes_ + needed));
  take_unused(entry);
  if (!entry.spilled) {
    entry.going = true;
    ++in_use_;
    const VoxelMap& map = entry.map->map();
    lock.unlock();
    std::optional<Expected<SpillPlace>> place;
    try {
      place = limits_.spill->write(bytes_of_map(map)).map_error(spill_error);
    } catch (const std::bad_alloc&) {
      place.reset();
    }
    lock.lock();
    --in_use_;
    entry.going = false;
    if (!place) return fail_all(std::move(no_memory_));
    if (!*place) return fail_all(std::move(place->error()));
    entry.spilled = **place;
  }
  used_bytes_ -= entry.bytes;
  bytes_since_trim_ += entry.bytes;
  entry.bytes = entry.fresh_bytes;
  std::unique_ptr<const SearchableMap> gone = std::move(entry.map);
  changed_.notify_all();
  const bool trim = bytes_since_trim_ >= limits_.memory_bytes / kTrimShare;
  if (trim) bytes_since_trim_ = 0;
  lock.unlock();  // giving megabytes back takes its time
  gone.reset();
  if (trim) give_pages_back();
  lock.lock();
}

void SubmapStore::bring_in(Lock& lock, std::size_t number) {
  Entry& entry = entries_[number];
  const SpillPlace place = *entry.spilled;
  ++in_use_;
  lock.unlock();
  std::optional<Expected<std::unique_ptr<const SearchableMap>>> map;
  try {
    map = read_again(place);
  } catch (const std::bad_alloc&) {
    map.reset();
  }
  lock.lock();
  --in_use_;
  entry.coming = false;
  if (!map) return fail_all(std::move(no_memory_));
  if (!*map) return fail_all(std::move(map->error()));
  entry.map = std::move(**map);
  changed_.notify_all();
}

Expected<std::unique_ptr<const SearchableMap>> SubmapStore::read_again(const SpillPlace& place) const {
  std::vector<std::byte> bytes(place.size);
  if (const Expected<void> read = limits_.spill->read(place, bytes); !read) return pass_up(spill_error(read.error()));
  std::optional<VoxelMap> map = map_of_bytes(bytes);
  if (!map) return pass_up(spill_error({ErrorCode::kIo, "what was read is not what was written", {}, {}}));
  return std::make_unique<const SearchableMap>(*std::move(map), setup_);
}

}  // namespace kilter
