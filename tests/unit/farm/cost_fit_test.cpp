// SPDX-License-Identifier: BSD-3-Clause
#include "farm/cost_fit.hpp"

#include <gtest/gtest.h>

namespace orchard::farm {
namespace {

TEST(CostFit, FindsWhatAMapCosts) {
  std::vector<CostSample> samples;
  for (int i = 1; i <= 20; ++i) {
    const double km = 0.1 * i, trees = 10.0 * ((i * 7) % 23), mb = 30.0 * km;
    samples.push_back(
        {0.5 + 6.0 * km + 0.01 * trees, 90.0 + 64.0 * km + 0.07 * trees, km, trees, mb});
  }
  const CostFit fit = fit_costs(samples);
  EXPECT_NEAR(fit.time_s.at_least, 0.5, 1e-6);
  EXPECT_NEAR(fit.time_s.per_km, 6.0, 1e-6);
  EXPECT_NEAR(fit.time_s.per_tree, 0.01, 1e-6);
  EXPECT_NEAR(fit.memory_mb.per_km, 64.0, 1e-6);
  EXPECT_GT(fit.ask_mb.per_mb, 0.0);
}

TEST(CostFit, HasNoPartBelowZero) {
  // Trees that make a map cheaper: as they stand nearer together, say.
  std::vector<CostSample> samples;
  for (int i = 1; i <= 10; ++i) {
    const double km = 0.1 * i, trees = 100.0 / i;
    samples.push_back({1.0 + 5.0 * km - 0.001 * trees, 100.0, km, trees, 10.0});
  }
  const CostFit fit = fit_costs(samples);
  for (const CostLine& line : {fit.time_s, fit.memory_mb, fit.ask_s, fit.ask_mb}) {
    EXPECT_GE(line.at_least, 0.0);
    EXPECT_GE(line.per_km, 0.0);
    EXPECT_GE(line.per_tree, 0.0);
    EXPECT_GE(line.per_mb, 0.0);
  }
  EXPECT_GT(fit_costs({}).ask_s.at_least, 0.0) << "something is asked for before the first map";
}

}  // namespace
}  // namespace orchard::farm
