// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/reliability.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "simulation/random.hpp"

namespace orchard::evaluation {
namespace {

TEST(Reliability, ByHand) {
  // bin 0.2-0.3: mean 0.25, half came true; bin 0.9-1: mean 0.95, all came true
  const Reliability r = reliability({{0.24, true}, {0.26, false}, {0.9, true}, {1.0, true}});
  EXPECT_EQ(r.num, 4);
  EXPECT_EQ(r.bins[2].num, 2);
  EXPECT_DOUBLE_EQ(r.bins[2].mean_probability, 0.25);
  EXPECT_DOUBLE_EQ(r.bins[2].frequency, 0.5);
  EXPECT_EQ(r.bins[9].num, 2);
  EXPECT_NEAR(r.expected_calibration_error, 0.5 * 0.25 + 0.5 * 0.05, 1e-12);
  EXPECT_NEAR(r.brier_score, (0.76 * 0.76 + 0.26 * 0.26 + 0.01) / 4.0, 1e-12);
}

TEST(Reliability, HonestForecastsHaveNoErrorAndBoastfulOnesDo) {
  simulation::Random random(5);
  std::vector<Forecast> honest, boastful;
  for (int i = 0; i < 20000; ++i) {
    const double p = random.uniform();
    const bool came_true = random.uniform() < p;
    honest.push_back({p, came_true});
    boastful.push_back({p < 0.5 ? 0.5 * p : 1.0 - 0.5 * (1.0 - p), came_true});
  }
  EXPECT_LT(reliability(honest).expected_calibration_error, 0.015);
  EXPECT_NEAR(reliability(boastful).expected_calibration_error, 0.125, 0.015);
}

TEST(Reliability, Refuses) {
  EXPECT_EQ(reliability({}).expected_calibration_error, 0.0);
  EXPECT_THROW(reliability({{1.1, true}}), std::invalid_argument);
  EXPECT_THROW(reliability({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::evaluation
