// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/antenna_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

const Eigen::Vector2d kAntenna(-0.3, 0.7);  // in the laser frame

/// Stretches of a path that turns by `turn_rad` at each of 40 keys, to the one side and the other,
/// each laid anywhere in ENU by a receiver's slow error.
std::vector<std::vector<AntennaView>> stretches(int num, double turn_rad, double fix_sd_m,
                                                unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<std::vector<AntennaView>> all;
  for (int k = 0; k < num; ++k) {
    const Eigen::Vector3d T_enu_path(100.0 + 2.0 * noise(random), 50.0 + 2.0 * noise(random),
                                     0.8 * k);
    Eigen::Vector3d T = Eigen::Vector3d::Zero();
    std::vector<AntennaView> views;
    for (int i = 0; i < 40; ++i) {
      T = geometry::compose(T, {0.4, 0.0, i < 20 ? turn_rad : -turn_rad});
      const Eigen::Vector2d p = geometry::transform(T_enu_path, geometry::transform(T, kAntenna));
      views.push_back({T, p + fix_sd_m * Eigen::Vector2d(noise(random), noise(random))});
    }
    all.push_back(views);
  }
  return all;
}

TEST(AntennaEstimate, TurnsTellWhereItIs) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto found = estimate_antenna(stretches(4, 0.12, 0.05, seed));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->num_fixes, 160);
    const Eigen::Vector2d error = found->p_laser_m - kAntenna;
    EXPECT_LT(error.norm(), 0.15);
    EXPECT_LT(error.dot(found->covariance.inverse() * error), 16.0) << seed;
  }
}

TEST(AntennaEstimate, AStraightPathDoesNotTell) {
  const auto found = estimate_antenna(stretches(4, 0.0, 0.02, 1));
  ASSERT_TRUE(found);
  EXPECT_GT(std::sqrt(found->covariance.trace()), 1.0);
}

TEST(AntennaEstimate, AJumpOfSomeFixesHasLittleSay) {
  auto all = stretches(4, 0.12, 0.02, 2);
  for (std::size_t i = 5; i < 10; ++i) all[1][i].p_enu_m += Eigen::Vector2d(6.0, -4.0);
  const auto found = estimate_antenna(all);
  ASSERT_TRUE(found);
  EXPECT_LT((found->p_laser_m - kAntenna).norm(), 0.1);
}

TEST(AntennaEstimate, AFewFixesSayNothing) { EXPECT_FALSE(estimate_antenna({})); }

}  // namespace
}  // namespace orchard::pose
