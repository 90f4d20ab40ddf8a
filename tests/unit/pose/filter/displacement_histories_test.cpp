// SPDX-License-Identifier: BSD-3-Clause
// Truth: probabilities by Bayes' rule, worked by hand.
#include "pose/filter/fix_hypotheses.hpp"

#include <gtest/gtest.h>

namespace orchard::pose {
namespace {

DisplacementHistories displaced_once(std::int64_t begin_utime, std::int64_t end_utime) {
  DisplacementHistories histories;
  histories.begin(begin_utime, true);
  histories.extend(end_utime);
  return histories;
}

TEST(DisplacementHistories, AMergeKeepsBothByTheirOdds) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  ASSERT_EQ(histories.all().size(), 2U);
  EXPECT_DOUBLE_EQ(histories.all()[0].probability, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(histories.all()[1].probability, 1.0 / 3.0);
  EXPECT_EQ(histories.likeliest().size(), 1U);
}

TEST(DisplacementHistories, TheSameHistoryOnTwoWaysAddsUp) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  histories.merge(DisplacementHistories(), 1.0);
  ASSERT_EQ(histories.all().size(), 2U);
  EXPECT_TRUE(histories.likeliest().empty());
  EXPECT_DOUBLE_EQ(histories.all()[0].probability, 1.0 / 6.0 + 1.0 / 2.0);
}

TEST(DisplacementHistories, WhatComesLaterBelongsToEach) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  histories.begin(20, false);
  histories.extend(30);
  const DisplacedTime later{20, 30, false};
  for (const DisplacementHistory& history : histories.all()) {
    EXPECT_EQ(history.displaced.back(), later);
  }
  EXPECT_EQ(histories.all()[0].displaced.size(), 2U);
  EXPECT_EQ(histories.all()[1].displaced.size(), 1U);
}

TEST(DisplacementHistories, TheUnlikelyIsForgottenAndTheRestSumsToOne) {
  DisplacementHistories histories;
  for (int i = 1; i <= 30; ++i) histories.merge(displaced_once(i, i + 1), 0.2);
  double sum = 0.0;
  for (const DisplacementHistory& history : histories.all()) sum += history.probability;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT(histories.all().size(), 10U);
  histories.merge(displaced_once(99, 100), 1e-3);
  for (const DisplacementHistory& history : histories.all()) {
    EXPECT_NE(history.displaced.front().begin_utime, 99);
  }
}

}  // namespace
}  // namespace orchard::pose
