// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>

#include "kilter/base/contract.h"
#include "kilter/submap/ids.h"

namespace kilter {

/// An N x N matrix over ordered submap pairs, row = source, column = target, that holds only what was computed: a pair
/// not tested, failed or infinite is absent, never 0 or NaN. `Meaning` keeps matrices of opposite sign apart.
template <class Meaning>
class PairMatrix {
 public:
  /// For `size` submaps (the paper's N), all cells absent.
  explicit PairMatrix(int size = 0) : size_(size) { KILTER_EXPECTS(size >= 0); }

  [[nodiscard]] int size() const { return size_; }

  /// Precondition: both ids in [0, size). Replaces what was there; O(log entries).
  void set(PairId pair, double value) {
    KILTER_EXPECTS(contains(pair.source) && contains(pair.target));
    values_[pair] = value;
  }

  [[nodiscard]] std::optional<double> get(PairId pair) const {
    const auto found = values_.find(pair);
    return found == values_.end() ? std::nullopt : std::optional(found->second);
  }

  /// All present cells, row by row.
  [[nodiscard]] const std::map<PairId, double>& entries() const { return values_; }

  bool operator==(const PairMatrix&) const = default;

 private:
  [[nodiscard]] bool contains(SubmapId id) const { return id.value >= 0 && id.value < size_; }

  int size_;
  std::map<PairId, double> values_;
};

/// Gamma (Eq. 15, at the map's poses) and Theta (after registration), in 1/m^3. Large means *consistent*, although the
/// paper calls Gamma an inconsistency matrix.
using ConsistencyMatrix = PairMatrix<struct LargeMeansConsistent>;

/// Gamma^v = Theta - Gamma (Algorithm 1), in 1/m^3. Large means *verified inconsistency*.
using InconsistencyMatrix = PairMatrix<struct LargeMeansInconsistent>;

/// Theta - Gamma where both are present, absent elsewhere: a failed registration verifies nothing.
/// Precondition: equal sizes.
[[nodiscard]] InconsistencyMatrix verified(const ConsistencyMatrix& theta, const ConsistencyMatrix& gamma);

}  // namespace kilter
