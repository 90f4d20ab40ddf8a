// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/bulk_centre.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace orchard::mapping {
namespace {

TEST(BulkCentre, OfOnePointIsThePoint) {
  const BulkCentre centre = bulk_centre({{{3.0, -4.0}, 400.0}}, {3.0, -4.0}, 0.2);
  EXPECT_NEAR(centre.p_map.x(), 3.0, 1e-12);
  EXPECT_NEAR(centre.p_map.y(), -4.0, 1e-12);
  EXPECT_DOUBLE_EQ(centre.covariance(0, 0), 1.0 / 400.0);
  EXPECT_EQ(centre.covariance(0, 1), 0.0);
}

TEST(BulkCentre, WithinItsKernelIsTheWeightedMean) {
  const std::vector<WeightedPoint> points = {{{1.0, 2.0}, 100.0}, {{1.02, 2.0}, 300.0}};
  const BulkCentre centre = bulk_centre(points, {1.01, 2.0}, 5.0);
  EXPECT_NEAR(centre.p_map.x(), 1.015, 1e-6);
  EXPECT_NEAR(centre.p_map.y(), 2.0, 1e-12);
}

TEST(BulkCentre, IsNotDrawnByAnotherThing) {
  std::vector<WeightedPoint> points;
  for (int k = -5; k <= 5; ++k) points.push_back({{0.01 * k, 0.0}, 100.0});
  const std::vector<WeightedPoint> alone = points;
  for (int k = 0; k < 4; ++k) points.push_back({{1.5, 0.5}, 100.0});
  const BulkCentre centre = bulk_centre(points, {0.4, 0.13}, 0.2);  // from the mean of all
  const BulkCentre without = bulk_centre(alone, {0.0, 0.0}, 0.2);
  EXPECT_LT((centre.p_map - without.p_map).norm(), 1e-6);
  EXPECT_NEAR(centre.covariance(0, 0), without.covariance(0, 0), 1e-9);
  // eleven points 1 cm apart: (2 (1 + 4 + 9 + 16 + 25) 1e-4 m2) / 10 / 11, a little less by the
  // kernel
  EXPECT_NEAR(without.covariance(0, 0), 1e-4, 2e-6);
}

}  // namespace
}  // namespace orchard::mapping
