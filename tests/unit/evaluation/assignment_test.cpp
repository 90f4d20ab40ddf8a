// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace orchard::evaluation {
namespace {

struct Score {
  int num_pairs = 0;
  double sum_m2 = 0.0;
};

double uniform(std::mt19937_64& engine, double lo, double hi) {
  return lo + (hi - lo) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

double squared_distance_m2(const Point& a, const Point& b) {
  return (a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m);
}

/// The best pairing by trying every one: the definition itself.
void search(const std::vector<Point>& truth, const std::vector<Point>& found, double gate_m,
            std::size_t t, std::vector<bool>& used, Score score, Score& best) {
  if (t == truth.size()) {
    if (score.num_pairs > best.num_pairs ||
        (score.num_pairs == best.num_pairs && score.sum_m2 < best.sum_m2)) {
      best = score;
    }
    return;
  }
  search(truth, found, gate_m, t + 1, used, score, best);
  for (std::size_t f = 0; f < found.size(); ++f) {
    const double distance_m2 = squared_distance_m2(truth[t], found[f]);
    if (used[f] || distance_m2 > gate_m * gate_m) continue;
    used[f] = true;
    search(truth, found, gate_m, t + 1, used, {score.num_pairs + 1, score.sum_m2 + distance_m2},
           best);
    used[f] = false;
  }
}

Score score_of(const std::vector<Point>& truth, const std::vector<Point>& found,
               const Assignment& assignment) {
  Score score;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (assignment[t] == kUnmatched) continue;
    ++score.num_pairs;
    score.sum_m2 += squared_distance_m2(truth[t], found[static_cast<std::size_t>(assignment[t])]);
  }
  return score;
}

TEST(Assign, IsAsGoodAsTryingEveryPairing) {
  std::mt19937_64 engine(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<Point> truth(engine() % 6);
    std::vector<Point> found(engine() % 7);
    for (Point& p : truth) p = {uniform(engine, 0, 1), uniform(engine, 0, 1)};
    for (Point& p : found) p = {uniform(engine, 0, 1), uniform(engine, 0, 1)};
    const double gate_m = uniform(engine, 0.05, 0.8);
    Score best;
    std::vector<bool> used(found.size(), false);
    search(truth, found, gate_m, 0, used, {}, best);
    const Score got = score_of(truth, found, assign(truth, found, gate_m));
    EXPECT_EQ(got.num_pairs, best.num_pairs) << "round " << round;
    EXPECT_NEAR(got.sum_m2, best.sum_m2, 1e-12) << "round " << round;
  }
}

TEST(Assign, UsesEachFoundPointOnceAndKeepsToTheGate) {
  std::mt19937_64 engine(11);
  std::vector<Point> truth(400);
  std::vector<Point> found(500);
  for (Point& p : truth) p = {uniform(engine, 0, 30), uniform(engine, 0, 30)};
  for (Point& p : found) p = {uniform(engine, 0, 30), uniform(engine, 0, 30)};
  const Assignment assignment = assign(truth, found, 0.5);
  std::vector<int> uses(found.size(), 0);
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (assignment[t] == kUnmatched) continue;
    const auto f = static_cast<std::size_t>(assignment[t]);
    EXPECT_EQ(++uses[f], 1);
    EXPECT_LE(squared_distance_m2(truth[t], found[f]), 0.25);
  }
}

TEST(Assign, DoesNotDependOnTheOrderOfPoints) {
  std::mt19937_64 engine(3);
  std::vector<Point> truth(60);
  std::vector<Point> found(70);
  for (Point& p : truth) p = {uniform(engine, 0, 3), uniform(engine, 0, 3)};
  for (Point& p : found) p = {uniform(engine, 0, 3), uniform(engine, 0, 3)};
  const Assignment straight = assign(truth, found, 0.4);
  std::vector<Point> reversed(found.rbegin(), found.rend());
  const Assignment backwards = assign(truth, reversed, 0.4);
  const auto num_found = static_cast<std::ptrdiff_t>(found.size());
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto expected = straight[t] == kUnmatched ? kUnmatched : num_found - 1 - straight[t];
    EXPECT_EQ(backwards[t], expected);
  }
}

TEST(Assign, MorePairsBeatCloserPairs) {
  // Nearest first would give the middle point to truth 0 and leave truth 1 without any.
  const std::vector<Point> truth{{0.0, 0.0}, {1.0, 0.0}};
  const std::vector<Point> found{{-0.9, 0.0}, {0.45, 0.0}};
  EXPECT_EQ(assign(truth, found, 1.0), (Assignment{0, 1}));
}

TEST(Assign, NothingToMatch) {
  EXPECT_TRUE(assign({}, {{0, 0}}, 1.0).empty());
  EXPECT_EQ(assign({{0, 0}}, {}, 1.0), Assignment{kUnmatched});
  EXPECT_EQ(assign({{0, 0}}, {{2, 0}}, 1.0), Assignment{kUnmatched});
}

TEST(Assign, RefusesWhatCannotBe) {
  EXPECT_THROW(assign({}, {}, 0.0), std::invalid_argument);
  EXPECT_THROW(assign({}, {}, std::nan("")), std::invalid_argument);
  EXPECT_THROW(assign({{std::nan(""), 0}}, {}, 1.0), std::invalid_argument);
  EXPECT_THROW(assign({}, {{0, std::numeric_limits<double>::infinity()}}, 1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace orchard::evaluation
