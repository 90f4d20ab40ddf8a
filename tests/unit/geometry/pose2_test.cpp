// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <mrpt/poses/CPose2D.h>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "unit/central_difference.hpp"

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

/// Random poses, points and covariances from one seed.
class Draws {
 public:
  Eigen::Vector3d pose() { return {uniform(-50, 50), uniform(-50, 50), uniform(-3.1, 3.1)}; }
  Eigen::Vector2d point() { return {uniform(-50, 50), uniform(-50, 50)}; }

 private:
  double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  std::mt19937 random_{5};
};

TEST(Pose2, AQuarterTurnToTheLeft) {
  const Pose2 T_map_base{1.0, 2.0, 0.5 * kPi};
  EXPECT_NEAR((transform(T_map_base, {3.0, 1.0}) - Eigen::Vector2d(0.0, 5.0)).norm(), 0.0, 1e-12);
  const Pose2 further = compose(T_map_base, {3.0, 1.0, kPi});
  EXPECT_NEAR(further.x_m, 0.0, 1e-12);
  EXPECT_NEAR(further.y_m, 5.0, 1e-12);
  EXPECT_NEAR(further.yaw_rad, -0.5 * kPi, 1e-12);
}

TEST(Pose2, IsAGroup) {
  Draws draw;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d T_a_b = draw.pose(), T_b_c = draw.pose(), T_c_d = draw.pose();
    const Eigen::Vector2d p = draw.point();
    EXPECT_NEAR((inverse_transform(T_a_b, transform(T_a_b, p)) - p).norm(), 0.0, 1e-12);
    EXPECT_NEAR((transform(inverse(T_a_b), p) - inverse_transform(T_a_b, p)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(compose(T_a_b, inverse(T_a_b)).norm(), 0.0, 1e-12);
    const Eigen::Vector3d left = compose(compose(T_a_b, T_b_c), T_c_d);
    const Eigen::Vector3d right = compose(T_a_b, compose(T_b_c, T_c_d));
    EXPECT_NEAR((left - right).head<2>().norm(), 0.0, 1e-11);
    EXPECT_NEAR(wrap_angle_rad(left.z() - right.z()), 0.0, 1e-12);
    const Eigen::Vector3d found = between(T_a_b, compose(T_a_b, T_b_c));
    EXPECT_NEAR((found - T_b_c).norm(), 0.0, 1e-11);
  }
}

TEST(Pose2, NamedAndVectorFormAreTheSameNumbers) {
  Draws draw;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d a = draw.pose(), b = draw.pose();
    EXPECT_EQ(compose(pose2_of(a), pose2_of(b)).vector(), compose(a, b));
    EXPECT_EQ(between(pose2_of(a), pose2_of(b)).vector(), between(a, b));
    EXPECT_EQ(inverse(pose2_of(a)).vector(), inverse(a));
  }
}

TEST(Pose2, JacobiansAreTheCentralDifferences) {
  Draws draw;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d T_a_b = draw.pose(), T_b_c = 0.1 * draw.pose();
    const Eigen::Vector2d p_b = draw.point();
    // How far the pose moves from where it is: an angle that does not wrap.
    const auto moved = [&](const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
      Eigen::Vector3d d = compose(first, second) - compose(T_a_b, T_b_c);
      d.z() = wrap_angle_rad(d.z());
      return d;
    };
    test::expect_jacobian(
        compose_jacobian_first(T_a_b, T_b_c),
        [&](const Eigen::VectorXd& x) { return moved(Eigen::Vector3d(x), T_b_c); }, T_a_b);
    test::expect_jacobian(
        compose_jacobian_second(T_a_b),
        [&](const Eigen::VectorXd& x) { return moved(T_a_b, Eigen::Vector3d(x)); }, T_b_c);
    test::expect_jacobian(
        point_jacobian(transform(T_a_b, p_b) - T_a_b.head<2>()),
        [&](const Eigen::VectorXd& x) { return transform(Eigen::Vector3d(x), p_b); }, T_a_b);
  }
}

TEST(Pose2, CovarianceOfAPointTurnsWithIt) {
  const double angle_rad = 0.7;
  const Eigen::Matrix2d P = (Eigen::Matrix2d() << 4.0, 1.0, 1.0, 2.0).finished();
  const Eigen::Matrix2d turned = rotation(angle_rad) * P * rotation(angle_rad).transpose();
  const auto [xx, xy, yy] = rotated_covariance({4.0, 1.0, 2.0}, angle_rad);
  EXPECT_NEAR(xx, turned(0, 0), 1e-12);
  EXPECT_NEAR(xy, turned(0, 1), 1e-12);
  EXPECT_NEAR(yy, turned(1, 1), 1e-12);
}

TEST(Pose2, ComposesAsMrptDoes) {
  Draws draw;
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector3d T_a_b = draw.pose(), T_b_c = draw.pose();
    const mrpt::poses::CPose2D theirs = mrpt::poses::CPose2D(T_a_b.x(), T_a_b.y(), T_a_b.z()) +
                                        mrpt::poses::CPose2D(T_b_c.x(), T_b_c.y(), T_b_c.z());
    const Eigen::Vector3d ours = compose(T_a_b, T_b_c);
    EXPECT_NEAR(ours.x(), theirs.x(), 1e-11);
    EXPECT_NEAR(ours.y(), theirs.y(), 1e-11);
    EXPECT_NEAR(wrap_angle_rad(ours.z() - theirs.phi()), 0.0, 1e-12);
  }
}

std::vector<double> shuffled(int n, std::mt19937& random) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i);
  std::shuffle(values.begin(), values.end(), random);
  return values;
}

TEST(Statistics, QuantileIsTheValueOfItsRank) {
  std::mt19937 random(7);
  for (const int n : {1, 2, 3, 4, 10, 101}) {
    const std::vector<double> values = shuffled(n, random);
    EXPECT_EQ(quantile(values, 0.0), 0.0);
    EXPECT_EQ(quantile(values, 0.75), 3 * n / 4);
    EXPECT_EQ(quantile(values, 1.0), n - 1);
    EXPECT_EQ(median(values), n / 2);
  }
}

TEST(Statistics, MidpointMedianHalvesTheMiddle) {
  EXPECT_EQ(midpoint_median({4.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(midpoint_median({4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_EQ(midpoint_median({5.0}), 5.0);
}

TEST(Statistics, NoValuesGiveZero) {
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  EXPECT_EQ(midpoint_median({}), 0.0);
  EXPECT_EQ(robust_sd({}), 0.0);
}

TEST(Statistics, RobustSdIsThatOfANormalDistributionDespiteOutliers) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.3);
  std::vector<double> deviations;
  for (int i = 0; i < 20000; ++i) deviations.push_back(normal(random));
  EXPECT_NEAR(robust_sd(deviations), 0.3, 0.01);
  for (int i = 0; i < 400; ++i) deviations.push_back(1e6);
  EXPECT_NEAR(robust_sd(deviations), 0.3, 0.02);
}

TEST(Statistics, GatesHoldTheStatedFractionOfTheChiSquareDistribution) {
  EXPECT_NEAR(1.0 - std::exp(-0.5 * kChiSquare2_997), 0.9973, 1e-4);
  EXPECT_NEAR(1.0 - std::exp(-0.5 * kChiSquare2_999), 0.999, 1e-4);
}

}  // namespace
}  // namespace orchard::geometry
