// SPDX-License-Identifier: BSD-3-Clause
#include "pose/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;

constexpr double kPeriod_s = 0.1;
constexpr double kSpeed_mps = 1.0;
constexpr double kTurn_radps = 0.8;

/// Heading of a robot that begins to turn at once at 1.03 s and ceases at 2.57 s.
double yaw_at(double t_s) { return kTurn_radps * (std::clamp(t_s, 1.03, 2.57) - 1.03); }

std::int64_t utime_at(double t_s) { return std::llround(1e6 * t_s) + 1; }

/// Encoders count what was turned since the reading before.
Odometry reading(int i) {
  Odometry odometry;
  odometry.utime = utime_at(i * kPeriod_s);
  odometry.speed_mps = kSpeed_mps;
  odometry.yaw_rate_radps = (yaw_at(i * kPeriod_s) - yaw_at((i - 1) * kPeriod_s)) / kPeriod_s;
  return odometry;
}

TEST(DeadReckoning, AReadingIsTheMeanSinceTheOneBefore) {
  DeadReckoning motion{SlamConfig{}};
  for (int i = 0; i <= 40; ++i) {
    motion.add(reading(i));
    EXPECT_NEAR(motion.motion().delta.z(), yaw_at(i * kPeriod_s), 1e-9) << i;
  }
}

TEST(DeadReckoning, ReadingsOfTheMomentLieWithinItsUncertainty) {
  DeadReckoning counted{SlamConfig{}};
  counted.set_default_noise(0.0, 0.0);
  Odometry odometry;
  odometry.utime = utime_at(0.0);
  counted.add(odometry);
  odometry.utime = utime_at(kPeriod_s);
  odometry.yaw_rate_radps = kTurn_radps;
  counted.add(odometry);
  // evenly between none and all of the turn
  EXPECT_NEAR(std::sqrt(counted.motion().covariance(2, 2)), kTurn_radps * kPeriod_s / std::sqrt(12),
              1e-6);
}

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

TEST(DeadReckoning, AReadingThatFollowsTellsAllTheTimeBetween) {
  for (const bool is_lost : {false, true}) {  // the reading between
    DeadReckoning reckoning{SlamConfig{}};
    Odometry first = odometry(0.0, 1.0), next = odometry(4.0, 1.0);
    first.seq = 7;
    next.seq = is_lost ? 9 : 8;
    reckoning.add(first);
    reckoning.add(next);
    EXPECT_NEAR(reckoning.motion().delta.x(), 4.0, 1e-9);
    // 1 cm/s by the reading, or half a metre per second and second
    EXPECT_NEAR(std::sqrt(reckoning.motion().covariance(0, 0)), is_lost ? 1.0 : 0.04, 0.01);
  }
}

TEST(DeadReckoning, AGuessIsRememberedUntilTheNextMotionBegins) {
  const Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  DeadReckoning reckoning{SlamConfig{}};
  reckoning.advance_to(0);
  reckoning.add(1'000'000, {0.5, 0.0, 0.0}, covariance);
  EXPECT_FALSE(reckoning.motion().has_guess);
  reckoning.add(2'000'000, {0.5, 0.0, 0.0}, covariance, true);
  reckoning.add(3'000'000, {0.5, 0.0, 0.0}, covariance);
  EXPECT_TRUE(reckoning.motion().has_guess);
  reckoning.restart(OdometryCalibration::Zero());
  EXPECT_FALSE(reckoning.motion().has_guess);
}

TEST(DeadReckoning, AMeasuredMotionHoldsWhatWasExtrapolated) {
  // Fixes between the scans ask for the pose, and a new motion begins at one of them.
  const Eigen::Vector3d step(0.5, 0.1, 0.2);
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  DeadReckoning reckoning{SlamConfig{}};
  Eigen::Vector3d T_map_begin(0.0, 0.0, 0.0), truth(0.0, 0.0, 0.0);
  reckoning.advance_to(0);
  for (int i = 1; i <= 10; ++i) {
    reckoning.add(i * 1'000'000, step, covariance);
    truth = compose(truth, step);
    EXPECT_LT((compose(T_map_begin, reckoning.motion().delta) - truth).norm(), 1e-9) << i;
    reckoning.advance_to(i * 1'000'000 + 300'000);
    if (i % 3 != 0) continue;
    T_map_begin = compose(T_map_begin, reckoning.motion().delta);
    reckoning.restart(OdometryCalibration::Zero());
    reckoning.advance_to(i * 1'000'000 + 600'000);
  }
}

TEST(DeadReckoning, AMeasuredMotionFollowsTheCalibrationOfTheWheelsInIt) {
  // Measured motions with a derivative, told after a silence, on a reckoning that is calibrated
  // already. Their sum by another calibration against the sum of each by that calibration.
  Eigen::Matrix3d J;
  J << 0.30, 0.02, -0.01, 0.01, -0.15, 0.08, 0.00, 0.20, -0.40;
  const Eigen::Vector3d told(0.3, 0.02, 0.1);
  const Eigen::Matrix3d P = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  const auto driven = [&](const OdometryCalibration& at) {
    DeadReckoning reckoning{SlamConfig{}};
    reckoning.add(utime_at(0.0), Eigen::Vector3d::Zero(), P);
    reckoning.restart(at);
    for (int i = 1; i <= 4; ++i) {
      reckoning.advance_to(utime_at(0.3 * i - 0.1));
      reckoning.add(utime_at(0.3 * i), told, P, false, J);
    }
    return reckoning.motion();
  };
  const OdometryCalibration none = OdometryCalibration::Zero(), some(0.01, -0.02, 0.003);
  EXPECT_TRUE(driven(some).delta.isApprox(driven(none).delta_with(some), 1e-3));
  for (int column = 0; column < 3; ++column) {
    const OdometryCalibration little = 1e-6 * OdometryCalibration::Unit(column);
    const Eigen::Vector3d slope = (driven(some + little).delta - driven(some).delta) / 1e-6;
    EXPECT_LT((slope - driven(some).calibration_jacobian.col(column)).norm(), 1e-5) << column;
  }
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
