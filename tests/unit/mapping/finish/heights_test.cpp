// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/heights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace orchard::mapping {
namespace {

/// Two aisles along x, beside a row of trees at y = 0, on a plane of 10 % and -5 %.
double plane_m(double x_m, double y_m) { return 3.0 + 0.10 * x_m - 0.05 * y_m; }

pose::GroundProfile aisles(const std::vector<double>& ys_m, bool has_tilt) {
  pose::GroundProfile ground;
  ground.shared_variance_m2 = 4e-4;
  for (const double y_m : ys_m) {
    for (int x = 0; x <= 40; ++x) {
      pose::GroundPoint& p = ground.points.emplace_back();
      p.x_m = x, p.y_m = y_m, p.z_m = plane_m(x, y_m), p.variance_m2 = 1e-4;
      if (has_tilt) p.gradient = Eigen::Vector2d(0.10, -0.05);
    }
  }
  return ground;
}

std::vector<Landmark> tree_at(double x_m, double y_m) {
  Landmark l;
  l.id = 1, l.x_m = x_m, l.y_m = y_m;
  return {l};
}

TEST(Heights, TheGroundAtATrunkIsThatOfThePlaneNearby) {
  for (const auto& [ys_m, has_tilt] : {std::pair(std::vector<double>{-2.0}, true),
                                       std::pair(std::vector<double>{-2.0, 2.0}, false)}) {
    auto trees = tree_at(13.3, 0.1);
    set_heights(aisles(ys_m, has_tilt), trees);
    EXPECT_NEAR(trees[0].z_m, plane_m(13.3, 0.1), 0.01);
    EXPECT_GT(trees[0].z_sd_m, 0.02);
    EXPECT_LT(trees[0].z_sd_m, 0.10);
  }
}

TEST(Heights, FromOneAisleWithoutATiltTheSlopeAcrossIsUnknownAndSaid) {
  auto trees = tree_at(13.3, 0.1);
  set_heights(aisles({-2.0}, false), trees);
  EXPECT_NEAR(trees[0].z_m, plane_m(13.3, 0.1), 2.0 * trees[0].z_sd_m);
  EXPECT_GT(trees[0].z_sd_m, 0.2);  // 2.1 m beside, on a slope of 12 % or less
}

TEST(Heights, FarFromThePathAndForUncertainHeightsTheyAreUnknown) {
  auto trees = tree_at(13.3, 12.0);
  set_heights(aisles({-2.0, 2.0}, true), trees);
  EXPECT_EQ(trees[0].z_sd_m, 0.0);
  auto near = tree_at(13.3, 0.0);
  pose::GroundProfile vague = aisles({-2.0, 2.0}, true);
  vague.shared_variance_m2 = 4.5;  // of single fixes, 3 m upwards
  set_heights(vague, near);
  EXPECT_EQ(near[0].z_sd_m, 0.0);
  set_heights({}, near);
  EXPECT_EQ(near[0].z_sd_m, 0.0);
}

}  // namespace
}  // namespace orchard::mapping
