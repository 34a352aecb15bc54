// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

namespace kilter {

/// A shift in cells and a turn in steps.
struct Move {
  Eigen::Vector3i cells = Eigen::Vector3i::Zero();
  int turn = 0;
  double score = 0.0;
};

/// Whether a is the better one; of equal scores, what moves less, then any fixed order. No two moves are equal.
[[nodiscard]] bool before(const Move& a, const Move& b);

/// How near another move has to be to be taken for the same, in cells and steps.
struct Nearness {
  int cells = 1;
  int turns = 2;
  double circle = std::numeric_limits<double>::infinity();  ///< steps of a whole turn, after which turns come round
};

/// Best first, none near a better one. \param moves  in any order, each once
[[nodiscard]] std::vector<Move> peaks(std::vector<Move> moves, std::size_t keep, const Nearness& nearness);

/// The best of any number of moves of one height, as many as it takes for their `keep` peaks to be those of all.
class BestMoves {
 public:
  BestMoves(std::size_t keep, const Nearness& nearness);

  void offer(const Move& move);
  [[nodiscard]] std::vector<Move> peaks() const { return kilter::peaks(best_, keep_, nearness_); }

 private:
  std::size_t keep_;
  Nearness nearness_;
  std::size_t most_;
  std::vector<Move> best_;  // a heap, the worst first
};

}  // namespace kilter
