// SPDX-License-Identifier: BSD-3-Clause
#include "pose/motion.hpp"

#include <gtest/gtest.h>

#include "geometry/pose2.hpp"

namespace orchard::pose {
using geometry::compose;

namespace {

TEST(RelativeMotion, PartsMakeTheWhole) {
  RelativeMotion first;
  RelativeMotion second;
  RelativeMotion both;
  for (int i = 0; i < 10; ++i) {
    first.drive(0.8, 0.3, {0.02, 0.0, 0.01}, 0.05);
    both.drive(0.8, 0.3, {0.02, 0.0, 0.01}, 0.05);
  }
  for (int i = 0; i < 10; ++i) {
    second.drive(0.5, -0.6, {0.02, 0.0, 0.01}, 0.05);
    both.drive(0.5, -0.6, {0.02, 0.0, 0.01}, 0.05);
  }
  EXPECT_LT((compose(first.delta, second.delta) - both.delta).norm(), 1e-12);
  const Eigen::Matrix3d P =
      compose_covariance(first.delta, first.covariance, second.delta, second.covariance);
  EXPECT_LT((P - both.covariance).norm(), 1e-12);
  EXPECT_NEAR(both.travel_m, 0.65, 1e-3);
}

Odometry odometry(double t_s, double speed_mps) {
  Odometry o;
  o.utime = static_cast<std::int64_t>(t_s * 1e6);
  o.speed_mps = speed_mps;
  o.covariance = {1e-4, 0.0, 1e-4};
  return o;
}

TEST(DeadReckoning, ASilenceGoesOnAtTheLastVelocityEverLessSurely) {
  DeadReckoning reckoning{SlamConfig{}};
  for (int i = 0; i <= 10; ++i) reckoning.add(odometry(0.1 * i, 1.0));
  EXPECT_NEAR(reckoning.motion().delta.x(), 1.0, 1e-9);
  const double before = reckoning.motion().covariance(0, 0);
  double last = before;
  for (int i = 1; i <= 10; ++i) {
    reckoning.advance_to(1'000'000 + i * 1'000'000);
    EXPECT_GT(reckoning.motion().covariance(0, 0), last);
    last = reckoning.motion().covariance(0, 0);
  }
  EXPECT_NEAR(reckoning.motion().delta.x(), 11.0, 1e-9);
  EXPECT_NEAR(reckoning.time_since_motion_s(), 10.0, 1e-9);
  EXPECT_GT(std::sqrt(last), 1.0);  // half a metre per second and second, independent seconds
}

TEST(DeadReckoning, TimeThatGoesBackAndNumbersThatAreNoneChangeNothing) {
  DeadReckoning reckoning{SlamConfig{}};
  reckoning.add(odometry(0.0, 1.0));
  reckoning.add(odometry(1.0, 1.0));
  const Eigen::Vector3d delta = reckoning.motion().delta;
  reckoning.add(odometry(0.5, 3.0));
  reckoning.add(odometry(2.0, std::nan("")));
  reckoning.add(500'000, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity());
  reckoning.advance_to(200'000);
  EXPECT_EQ(reckoning.motion().delta, delta);
  EXPECT_EQ(reckoning.utime(), 1'000'000);
}

}  // namespace
}  // namespace orchard::pose
