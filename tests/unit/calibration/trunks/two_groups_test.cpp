// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/two_groups.hpp"

#include <gtest/gtest.h>

namespace orchard::calibration {
namespace {

TEST(TwoGroups, FindsWhereTwoGroupsPart) {
  const auto groups = find_two_groups({5.1, 1.0, 1.2, 4.9, 0.8, 5.0, 5.2, 4.8}, 0.25, 0.0);
  ASSERT_TRUE(groups);
  EXPECT_NEAR(groups->low_mean, 1.0, 1e-12);
  EXPECT_NEAR(groups->high_mean, 5.0, 1e-12);
  EXPECT_NEAR(groups->low_fraction, 3.0 / 8.0, 1e-12);
  EXPECT_NEAR(groups->threshold, 3.0, 1e-12);
  // s1^2 = 0.04, s2^2 = 0.025, by hand
  EXPECT_NEAR(groups->separation, 4.0 / 0.18027756, 1e-6);
}

TEST(TwoGroups, OneEvenPopulationHasTheSeparationOfTheTheory) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(i);
  EXPECT_NEAR(find_two_groups(values, 0.25, 0.0)->separation, 3.464, 0.01);
}

TEST(TwoGroups, StragglersAreNoGroupAndEqualNumbersHaveNoSpread) {
  EXPECT_FALSE(find_two_groups({1, 2, 3}, 0.25, 0.0));
  std::vector<double> values(20, 1.0);
  EXPECT_NEAR(find_two_groups(values, 0.25, 0.1)->separation, 0.0, 1e-12);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.01 * static_cast<double>(i % 5);
  values[0] = 9.0;  // one of twenty
  EXPECT_LT(find_two_groups(values, 0.25, 0.0)->separation, 4.0);
}

}  // namespace
}  // namespace orchard::calibration
