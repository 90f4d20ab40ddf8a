// SPDX-License-Identifier: BSD-3-Clause
#include "pose/repeat_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::pose {
namespace {

TEST(RepeatModel, OfARateOfOneHalfAnyRateOfAnotherVisitIsAlike) {
  // Beta(1, 1) is the uniform distribution
  for (const double rate_min : {0.05, 0.1, 0.5, 0.9}) {
    EXPECT_NEAR(probability_seen_again(0.5, rate_min), 1.0 - rate_min, 1e-12);
  }
}

TEST(RepeatModel, IsTheBetaDistributionByItsIntegral) {
  // the density integrated by substitution: t = x^a takes the pole at 0 away
  const double rate = 0.3, rate_min = 0.12;
  const double a = 2.0 * rate, b = 2.0 * (1.0 - rate);
  const auto integral_to = [&](double end) {
    const int n = 200000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      const double t = std::pow(end, a) * (i + 0.5) / n;
      sum += std::pow(1.0 - std::pow(t, 1.0 / a), b - 1.0);
    }
    return sum * std::pow(end, a) / n / a;
  };
  // B(a, b) by the gamma function
  const double all = std::exp(std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b));
  EXPECT_NEAR(probability_seen_again(rate, rate_min), 1.0 - integral_to(rate_min) / all, 1e-6);
}

TEST(RepeatModel, WhatIsSeenMostlyIsSeenAgainAndATwigIsNot) {
  EXPECT_GT(probability_seen_again(detection_rate(58, 60), 0.1), 0.99);
  EXPECT_LT(probability_seen_again(detection_rate(5, 60), 0.1), 0.35);
  double before = 0.0;
  for (int seen = 0; seen <= 60; ++seen) {
    const double again = probability_seen_again(detection_rate(seen, 60), 0.1);
    EXPECT_GT(again, before);
    before = again;
  }
}

TEST(RepeatModel, ItsEndsAreProbabilities) {
  EXPECT_EQ(probability_seen_again(1.0, 0.9), 1.0);
  EXPECT_EQ(probability_seen_again(0.0, 0.1), 0.0);
  EXPECT_EQ(probability_seen_again(0.4, 0.0), 1.0);
  EXPECT_EQ(probability_seen_again(0.4, 1.0), 0.0);
  for (const double rate : {1e-9, 1e-3, 0.999, 1.0 - 1e-9}) {
    const double p = probability_seen_again(rate, 0.1);
    EXPECT_GE(p, 0.0);
    EXPECT_LE(p, 1.0);
  }
  EXPECT_EQ(detection_rate(0, 0), 0.5);
  EXPECT_LT(detection_rate(1000, 10), 1.0);
}

TEST(RepeatModel, OfAClumpAnotherVisitShowsOnePart) {
  EXPECT_EQ(probability_same_part(0), 1.0);
  EXPECT_EQ(probability_same_part(3), 0.25);
  EXPECT_LE(clump_reach_m(10.0), 1.0);
  EXPECT_LT(clump_reach_m(0.9), 0.9);  // trees of a dense planting are no clump
}

}  // namespace
}  // namespace orchard::pose
