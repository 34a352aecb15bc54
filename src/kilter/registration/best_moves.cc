// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/best_moves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace kilter {

bool before(const Move& a, const Move& b) {
  if (a.score != b.score) return a.score > b.score;
  // Nearer first, then any fixed order.
  const auto key = [](const Move& m) {
    return std::array<int, 5>{m.cells.squaredNorm() + m.turn * m.turn, m.cells.x(), m.cells.y(), m.cells.z(), m.turn};
  };
  return key(a) < key(b);
}

std::vector<Move> peaks(std::vector<Move> moves, std::size_t keep, const Nearness& nearness) {
  std::sort(moves.begin(), moves.end(), before);
  std::vector<Move> kept;
  for (const Move& move : moves) {
    const bool beside = std::any_of(kept.begin(), kept.end(), [&](const Move& better) {
      const double turns = std::abs(move.turn - better.turn);
      return (move.cells - better.cells).cwiseAbs().maxCoeff() <= nearness.cells &&
             std::min(turns, nearness.circle - turns) <= nearness.turns;
    });
    if (beside) continue;
    kept.push_back(move);
    if (kept.size() == keep) break;
  }
  return kept;
}

// A peak hides no more moves than are near it, itself among them: before the last peak come at most those that the
// others hide. Where turns come round, steps need not: one more may lie near.
BestMoves::BestMoves(std::size_t keep, const Nearness& nearness) : keep_(keep), nearness_(nearness) {
  const auto side = static_cast<std::size_t>(2 * nearness.cells + 1);
  most_ = keep * side * side * static_cast<std::size_t>(2 * nearness.turns + (std::isinf(nearness.circle) ? 1 : 2));
  best_.reserve(most_);
}

void BestMoves::offer(const Move& move) {
  if (best_.size() == most_) {
    if (!before(move, best_.front())) return;
    std::pop_heap(best_.begin(), best_.end(), before);
    best_.pop_back();
  }
  best_.push_back(move);
  std::push_heap(best_.begin(), best_.end(), before);
}

}  // namespace kilter
