// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/best_moves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace kilter {
namespace {

using Row = std::tuple<int, int, int, double>;

std::vector<Row> rows(const std::vector<Move>& moves) {
  std::vector<Row> out;
  for (const Move& move : moves) out.emplace_back(move.cells.x(), move.cells.y(), move.turn, move.score);
  return out;
}

// All moves of a square, `levels` different scores between them.
std::vector<Move> square(int reach, int levels, std::mt19937& random) {
  std::vector<Move> moves;
  for (int turn = -reach; turn <= reach; ++turn) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        moves.push_back({{x, y, 0}, turn, static_cast<double>(random() % static_cast<unsigned>(levels))});
      }
    }
  }
  return moves;
}

TEST(BestMoves, HaveThePeaksOfAllMovesInWhateverOrderTheyCome) {
  std::mt19937 random(7);
  for (const int levels : {1, 2, 5, 1'000'000}) {
    for (const Nearness nearness : {Nearness{1, 2}, Nearness{0, 0}, Nearness{2, 1}, Nearness{1, 2, 19.2}}) {
      std::vector<Move> moves = square(9, levels, random);
      const std::vector<Row> of_all = rows(peaks(moves, 12, nearness));
      for (int round = 0; round < 3; ++round) {
        BestMoves best(12, nearness);
        for (const Move& move : moves) best.offer(move);
        EXPECT_EQ(rows(best.peaks()), of_all) << levels << " levels, round " << round;
        std::shuffle(moves.begin(), moves.end(), random);
      }
    }
  }
}

// Each peak at the middle of all that it can hide, and these better than every other peak: nothing may be forgotten.
TEST(BestMoves, APeakBehindAllThatOthersHideIsFound) {
  std::vector<Move> moves;
  for (int k = 0; k < 5; ++k) {
    for (int turn = -2; turn <= 2; ++turn) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const bool middle = x == 0 && y == 0 && turn == 0;
          moves.push_back({{10 * k + x, y, 0}, turn, 10.0 - k + (middle ? 0.5 : 0.0)});
        }
      }
    }
  }
  BestMoves best(5, {1, 2});
  for (const Move& move : moves) best.offer(move);
  for (int x = 100; x < 1000; ++x) best.offer({{x, 0, 0}, 0, 1.0});
  std::vector<Row> expected;
  for (int k = 0; k < 5; ++k) expected.emplace_back(10 * k, 0, 0, 10.5 - k);
  EXPECT_EQ(rows(best.peaks()), expected);
}

TEST(BestMoves, FewerThanAskedForAreAllThereIs) {
  BestMoves best(64, {1, 2});
  EXPECT_TRUE(best.peaks().empty());
  best.offer({{3, 0, 0}, 0, -1.0});
  best.offer({{-3, 0, 0}, 0, -1.0});
  EXPECT_EQ(rows(best.peaks()), (std::vector<Row>{{-3, 0, 0, -1.0}, {3, 0, 0, -1.0}}));
}

}  // namespace
}  // namespace kilter
