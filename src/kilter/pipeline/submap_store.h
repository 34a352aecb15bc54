// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/pipeline/searchable_map.h"
#include "kilter/pipeline/spill_space.h"
#include "kilter/submap/ids.h"

namespace kilter {

class SubmapStore;

/// A submap's map, in memory as long as this lives. It must not outlive its store.
class PinnedMap {
 public:
  PinnedMap(PinnedMap&& other) noexcept
      : store_(std::exchange(other.store_, nullptr)), id_(other.id_), map_(other.map_) {}
  PinnedMap(const PinnedMap&) = delete;
  PinnedMap& operator=(const PinnedMap&) = delete;
  PinnedMap& operator=(PinnedMap&&) = delete;
  ~PinnedMap();

  const SearchableMap& operator*() const { return *map_; }
  const SearchableMap* operator->() const { return map_; }

 private:
  friend class SubmapStore;
  PinnedMap(SubmapStore& store, SubmapId id, const SearchableMap& map) : store_(&store), id_(id), map_(&map) {}

  SubmapStore* store_;
  SubmapId id_;
  const SearchableMap* map_;
};

/// Both of a pair.
struct PinnedPair {
  PinnedMap source;
  PinnedMap target;
};

/// kOutOfMemory: "WHAT_NEEDS so many MB, more than --memory allows". Rounded apart, so that what is asked for is
/// enough.
[[nodiscard]] Error exceeds_memory(const std::string& what_needs, std::size_t needed_bytes, std::size_t allowed_bytes);

/// How much a store may hold, and where the rest goes.
struct StoreLimits {
  std::size_t memory_bytes = 0;  ///< 0 = no limit
  SpillSpace* spill = nullptr;   ///< may be null: then all submaps must fit. Must outlive the store
};

/// Holds the maps of a mission's submaps in bounded memory. What nobody uses goes out when room is needed, the least
/// recently used first: to the spill space, once, for a map never changes; whoever asks for it later gets the same bits
/// back. Callers wait while others use what fills the memory, so any number of threads gets along with room for a
/// single pair. What a field of nearest voxels grows to while a pair is pinned is counted when the last pin is
/// released; what then exceeds the limit goes out when somebody next asks for a map.
///
/// A thread that holds a pin must not ask for another: both of a pair are asked for at once. After a failure all
/// further calls fail with the same error. Any thread may call.
class SubmapStore {
 public:
  /// For submaps with ids 0 ... count - 1.
  SubmapStore(std::size_t count, const SearchSetup& setup, const StoreLimits& limits);

  /// Takes a submap's map; once for each id, before it is asked for.
  /// \return kOutOfMemory if it does not fit; kNoSpace where the spill space is full.
  [[nodiscard]] Expected<void> add(SubmapId id, VoxelMap map);

  /// \return the map; kOutOfMemory if it does not fit, or what the spill space failed with.
  [[nodiscard]] Expected<PinnedMap> pin(SubmapId id);
  [[nodiscard]] Expected<PinnedPair> pin(PairId pair);

 private:
  friend class PinnedMap;
  using Lock = std::unique_lock<std::mutex>;

  struct Entry {
    std::unique_ptr<const SearchableMap> map;  // absent while out
    std::size_t bytes = 0;                     // what it takes, or will take when it comes
    std::size_t fresh_bytes = 0;               // what it takes before anybody has searched in it
    std::optional<SpillPlace> spilled;
    int pins = 0;
    bool coming = false;                       // one thread reads it
    bool going = false;                        // one thread writes it
    std::list<std::size_t>::iterator place{};  // in unused_ or others_, for good
  };

  Expected<void> acquire(std::span<const std::size_t> numbers);
  void release(std::size_t number);
  // Whether `needed` bytes are free, or none are needed and all that is held beyond the limit is in use. If not, puts
  // one submap out or waits for a change; then look again, all may differ.
  Expected<bool> make_room(Lock& lock, std::size_t needed, std::span<const std::size_t> kept);
  // So that there is room for `needed` bytes.
  void put_out(Lock& lock, std::size_t number, std::size_t needed);
  void bring_in(Lock& lock, std::size_t number);
  [[nodiscard]] bool fits(std::size_t needed) const;
  [[nodiscard]] Error too_large(std::size_t needed) const;
  [[nodiscard]] Expected<std::unique_ptr<const SearchableMap>> read_again(const SpillPlace& place) const;
  void fail_all(Error error);
  void keep_unused(Entry& entry) noexcept { unused_.splice(unused_.end(), others_, entry.place); }
  void take_unused(Entry& entry) noexcept { others_.splice(others_.end(), unused_, entry.place); }

  SearchSetup setup_;
  StoreLimits limits_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Entry> entries_;
  std::list<std::size_t> unused_;     // held without pins, the least recently used first
  std::list<std::size_t> others_;     // all others: nothing is allocated where a number changes lists
  std::size_t used_bytes_ = 0;        // of all that is held, comes or goes
  std::size_t bytes_since_trim_ = 0;  // put out since freed pages were last given back
  int in_use_ = 0;                    // pins, and entries that come or go
  std::optional<Error> failure_;
  Error no_memory_;  // made beforehand, when there is some
};

}  // namespace kilter
