// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/extent.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::mapping {
namespace {

/// A landmark of which `num` observations scatter by `sd_m` per axis about their mean: the standard
/// error of a mean is the scatter over the root of their number.
Landmark tree(double sd_m, int num, int row) {
  Landmark l;
  l.label = detection::Label::kTree;
  l.num_observations = num;
  l.se_x_m = l.se_y_m = sd_m / std::sqrt(num);
  l.row = row;
  return l;
}

TEST(StemScatterTest, AreAsSharpAsTheTreesOfTheRows) {
  std::vector<Landmark> map;
  map.reserve(20);
  for (int i = 0; i < 20; ++i) map.push_back(tree(0.03 + 0.001 * i, 12 + 5 * i, 1 + i / 10));
  const StemScatterTest stems(map);
  EXPECT_TRUE(stems.contains(tree(0.04, 15, 0))) << "a stem in a hedge";
  EXPECT_FALSE(stems.contains(tree(0.15, 15, 0))) << "leaves, met at another depth each time";
  EXPECT_TRUE(stems.contains(tree(0.04, 400, 0))) << "however often it was seen";
  EXPECT_FALSE(stems.contains(tree(0.15, 400, 0)));
}

TEST(StemScatterTest, TooFewObservationsTellNothing) {
  const StemScatterTest stems({tree(0.03, 40, 1), tree(0.04, 40, 1)});
  EXPECT_FALSE(stems.contains(tree(0.01, 3, 0)));
}

TEST(StemScatterTest, AreTrees) {
  const StemScatterTest stems({tree(0.03, 40, 1), tree(0.04, 40, 1)});
  Landmark post = tree(0.01, 40, 0);
  post.label = detection::Label::kObject;
  EXPECT_FALSE(stems.contains(post));
}

TEST(StemScatterTest, WithoutRowsNothingIsCalledSharp) {
  const StemScatterTest stems({tree(0.03, 40, 0), tree(0.04, 40, 0)});
  EXPECT_FALSE(stems.contains(tree(0.01, 40, 0)));
}

}  // namespace
}  // namespace orchard::mapping
