// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::geometry {
namespace {

TEST(WrapAngle, StaysInHalfOpenTurnAndKeepsDirection) {
  for (double angle_rad = -50.0; angle_rad < 50.0; angle_rad += 0.37) {
    const double wrapped_rad = wrap_angle_rad(angle_rad);
    EXPECT_GT(wrapped_rad, -kPi);
    EXPECT_LE(wrapped_rad, kPi);
    EXPECT_NEAR(std::sin(wrapped_rad), std::sin(angle_rad), 1e-12);
    EXPECT_NEAR(std::cos(wrapped_rad), std::cos(angle_rad), 1e-12);
  }
  EXPECT_DOUBLE_EQ(wrap_angle_rad(-kPi), kPi);
}

// Shalal et al. 2013, eqs. 11, 12 for a robot that looks along the map's Y axis, against polar
// coordinates in our frames with the robot's yaw at 90 degrees.
TEST(PaperBearing, GivesTheSamePointAsEquations11And12) {
  const double x_robot_m = 1.5, y_robot_m = -0.7, yaw_rad = kPi / 2.0;
  for (double bearing_rad = -2.0; bearing_rad <= 2.0; bearing_rad += 0.25) {
    const double range_m = 2.0 + 0.3 * bearing_rad;
    const double beta_rad = paper_bearing_rad(bearing_rad);
    const double x_tree_m = x_robot_m + range_m * std::sin(beta_rad);
    const double y_tree_m = y_robot_m + range_m * std::cos(beta_rad);
    EXPECT_NEAR(x_tree_m, x_robot_m + range_m * std::cos(yaw_rad + bearing_rad), 1e-12);
    EXPECT_NEAR(y_tree_m, y_robot_m + range_m * std::sin(yaw_rad + bearing_rad), 1e-12);
  }
}

}  // namespace
}  // namespace orchard::geometry
