// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fusion_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "unit/central_difference.hpp"

namespace orchard::pose {
namespace {

using Vector = FusionFilter::Vector;
using Matrix = FusionFilter::Matrix;
using test::central_difference;

/// The motion of the state by its definition: arcs, each followed exactly in 400 short chords.
Eigen::VectorXd moved(const Eigen::VectorXd& x, const MotionStep& step, const Vector& kept) {
  const double wheels_m = step.speed_mps * step.dt_s;
  const double length_m = (1.0 + x[3] + x[7]) * wheels_m;
  const double measured_rad = step.yaw_rate_radps * step.dt_s;
  const double turn_rad = step.is_gyro ? measured_rad - x[5] * step.dt_s
                                       : (1.0 + x[6] + x[8]) * measured_rad + x[4] * length_m;
  constexpr int kChords = 400;
  Eigen::VectorXd y = x;
  for (int i = 0; i < kChords; ++i) {
    const double yaw_rad = x[2] + (i + 0.5) / kChords * turn_rad;
    y[0] += length_m / kChords * std::cos(yaw_rad);
    y[1] += length_m / kChords * std::sin(yaw_rad);
  }
  y[2] += turn_rad;
  return kept.cwiseProduct(y);
}

/// What of the slow errors is left after a step: the slips forget over 10 m, the receiver over
/// time.
Vector kept_of(const FusionFilter& filter, const FusionFilter& after) {
  Vector kept = Vector::Ones();
  for (int i : {7, 8, 9, 10}) {
    if (filter.mean()[i] != 0.0) kept[i] = after.mean()[i] / filter.mean()[i];
  }
  return kept;
}

PositionObservation position(double x_m, double y_m) {
  PositionObservation observation;
  observation.p_map_m = {x_m, y_m};
  observation.p_base_m = {0.4, -0.3};
  observation.covariance << 0.02, 0.005, 0.005, 0.01;
  observation.is_gnss = true;
  return observation;
}

/// A filter whose errors are all learnt in part: every coefficient of its covariance lives.
FusionFilter learnt(bool is_gyro) {
  FusionFilter filter{FusionConfig{}};
  filter.place({1.0, -2.0, 0.7}, Eigen::Vector3d(0.04, 0.03, 0.01).asDiagonal());
  filter.set_receiver_variance(0.5);
  filter.reset_receiver_error();
  filter.begin_displacement(0.3);
  MotionStep step{0.1, 1.0, 0.3, 0.05, 0.02, false};
  for (int i = 0; i < 60; ++i) {
    step.is_gyro = is_gyro || i % 2 == 0;
    filter.move(step);
    if (i % 10 != 9) continue;
    PositionObservation off = position(1.2 + 0.05 * i, -1.5 + 0.06 * i);
    off.is_displaced = i > 30;
    filter.correct(off);
  }
  return filter;
}

// P after a step without noise is F P F^T, but for what the errors' random walks add to their own
// variances. F leaves out how the chord's length changes with the turn: length x turn / 12.
TEST(FusionFilter, MotionCarriesTheCovarianceAsTheCentralDifferencesDo) {
  for (const bool is_gyro : {false, true}) {
    for (const double dt_s : {0.05, -0.05}) {
      const MotionStep step{dt_s, 1.5, 0.8, 0.0, 0.0, is_gyro};
      const FusionFilter before = learnt(is_gyro);
      FusionFilter after = before;
      after.move(step);
      const Vector kept = kept_of(before, after);
      const auto model = [&](const Eigen::VectorXd& x) { return moved(x, step, kept); };
      Eigen::VectorXd off = after.mean() - model(before.mean());
      off[2] = geometry::wrap_angle_rad(off[2]);
      EXPECT_LT(off.norm(), 1e-6);

      const auto numeric = central_difference(model, before.mean());
      const Eigen::MatrixXd expected = numeric.J * before.covariance() * numeric.J.transpose();
      const double length_m = std::abs(step.speed_mps * dt_s);
      const double turn_rad = std::abs(step.yaw_rate_radps * dt_s);
      // At 400 chords the sums of the model are off by 2e-6 of themselves.
      const double left_out = length_m * turn_rad / 12.0 * std::abs(dt_s) + 1e-7;
      const double largest = before.covariance().diagonal().maxCoeff();
      for (int i = 0; i < FusionFilter::kSize; ++i) {
        for (int j = 0; j < FusionFilter::kSize; ++j) {
          if (i == j && i > 2) continue;
          EXPECT_NEAR(after.covariance()(i, j), expected(i, j), 2.0 * left_out * largest)
              << i << ", " << j << " gyro " << is_gyro << " dt " << dt_s;
        }
      }
    }
  }
}

TEST(FusionFilter, NoiseOfAStepIsCarriedAsTheCentralDifferencesDo) {
  FusionConfig config;
  config.learns_wheels = false;  // each reading errs by itself: its variance over the step
  FusionFilter start(config);
  start.place({1.0, -2.0, 0.7}, Eigen::Matrix3d::Zero());
  const MotionStep quiet{0.1, 1.5, 0.6, 0.0, 0.0, false};
  MotionStep noisy = quiet;
  noisy.speed_sd_mps = 0.2;
  noisy.yaw_rate_sd_radps = 0.3;
  FusionFilter without = start, with = start;
  without.move(quiet);
  with.move(noisy);
  const auto pose = [&](const Eigen::VectorXd& readings) {
    MotionStep step = quiet;
    step.speed_mps = readings[0];
    step.yaw_rate_radps = readings[1];
    FusionFilter filter = start;
    filter.move(step);
    return Eigen::Vector3d(filter.mean().head<3>());
  };
  const Eigen::MatrixXd G = central_difference(pose, Eigen::Vector2d(1.5, 0.6)).J;
  const Eigen::Matrix3d expected = G * Eigen::Vector2d(0.04, 0.09).asDiagonal() * G.transpose();
  const Eigen::Matrix3d found = (with.covariance() - without.covariance()).topLeftCorner<3, 3>();
  const double left_out = 0.15 * 0.06 / 12.0 * 0.1;  // of G: length x turn / 12, per rad/s
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 2.0 * left_out * 0.1 * 0.09 + 1e-12);
}

TEST(FusionFilter, CorrectsByTheGainOfTheCentralDifferences) {
  for (const bool is_gnss : {false, true}) {
    for (const bool is_displaced : {false, true}) {
      // Pose and errors uncorrelated: the heading is linearised without a bend.
      FusionFilter filter{FusionConfig{}};
      filter.place({1.0, -2.0, 0.7}, Eigen::Vector3d(0.04, 0.03, 0.01).asDiagonal());
      filter.set_receiver_variance(0.5);
      filter.reset_receiver_error();
      filter.begin_displacement(0.3);
      PositionObservation observation = position(1.5, -1.8);
      observation.is_gnss = is_gnss;
      observation.is_displaced = is_displaced;
      const auto expected_position = [&](const Eigen::VectorXd& x) {
        Eigen::Vector2d p = geometry::transform(Eigen::Vector3d(x.head<3>()), observation.p_base_m);
        if (is_gnss) p += x.segment<2>(9);
        if (is_displaced) p += x.segment<2>(11);
        return p;
      };
      const Vector x = filter.mean();
      const Matrix P = filter.covariance();
      const Eigen::MatrixXd H = central_difference(expected_position, x).J;
      const Eigen::Matrix2d S = H * P * H.transpose() + observation.covariance;
      const Eigen::MatrixXd K = P * H.transpose() * S.inverse();
      const Eigen::Vector2d off_m = observation.p_map_m - expected_position(x);
      EXPECT_NEAR(filter.off_m(observation), off_m.norm(), 1e-12);
      EXPECT_NEAR(filter.mahalanobis2(observation), off_m.dot(S.inverse() * off_m), 1e-6);
      EXPECT_NEAR(filter.log_likelihood(observation, 0.0),
                  -0.5 * (off_m.dot(S.inverse() * off_m) + std::log(S.determinant())), 1e-6);
      filter.correct(observation);
      EXPECT_LT((filter.mean() - x - K * off_m).norm(), 1e-8);
      EXPECT_LT((filter.covariance() - P + K * S * K.transpose()).norm(), 1e-8);
    }
  }
}

TEST(FusionFilter, AFullCircleEndsWhereItBeganAndBackwardsIsTheWayBack) {
  FusionConfig config;
  config.learns_wheels = false;
  FusionFilter filter(config);
  constexpr int kSteps = 40;
  const MotionStep step{2.0 * geometry::kPi / kSteps, 1.0, 1.0, 0.0, 0.0, false};
  for (int i = 0; i < kSteps; ++i) filter.move(step);
  EXPECT_LT(filter.mean().head<3>().norm(), 1e-12);
  MotionStep back = step;
  filter.move(step);
  EXPECT_NEAR(filter.mean()[0], std::sin(step.dt_s), 1e-12);  // on the unit circle round (0, 1)
  EXPECT_NEAR(filter.mean()[1], 1.0 - std::cos(step.dt_s), 1e-12);
  back.dt_s = -step.dt_s;
  filter.move(back);
  EXPECT_LT(filter.mean().head<3>().norm(), 1e-12);
}

TEST(FusionFilter, AStandingGyroTellsItsBias) {
  FusionFilter filter{FusionConfig{}};
  for (int i = 0; i < 100; ++i) filter.correct_gyro_bias(0.013, 1e-4);
  // Prior of 0.02 rad/s against 100 readings of 0.01 rad/s: a Kalman filter's weighted mean.
  const double information = 1.0 / (0.02 * 0.02), told = 100.0 / 1e-4;
  EXPECT_NEAR(filter.sensor_errors().z(), 0.013 * told / (told + information), 1e-12);
  EXPECT_NEAR(filter.covariance()(5, 5), 1.0 / (told + information), 1e-15);
  filter.move({1.0, 0.0, 0.013, 0.0, 0.0, true});
  EXPECT_NEAR(filter.mean()[2], 0.013 * information / (told + information), 1e-12);
}

TEST(FusionFilter, ACompassTurnsAcrossTheWrapTheShortWay) {
  FusionFilter filter{FusionConfig{}};
  filter.place({0.0, 0.0, geometry::kPi - 0.1}, Eigen::Vector3d(0.0, 0.0, 0.01).asDiagonal());
  filter.correct_yaw(-geometry::kPi + 0.1, 0.01);
  EXPECT_NEAR(std::abs(filter.mean()[2]), geometry::kPi, 1e-12);  // half way
  EXPECT_NEAR(filter.covariance()(2, 2), 0.005, 1e-12);
}

TEST(FusionFilter, DecorrelatesAHeadingThatBendsThePathAndKeepsOneThatDoesNot) {
  FusionConfig config;
  config.learns_wheels = false;
  FusionFilter filter(config);
  filter.place({0.0, 0.0, 0.0}, Eigen::Vector3d(0.0, 0.0, 0.25).asDiagonal());
  for (int i = 0; i < 100; ++i) filter.move({0.1, 1.0, 0.0, 0.0, 0.0, true});
  // 10 m at 0.5 rad: the covariance of place and heading is L var(a), the bend 0.75 L^2 var(a)^2.
  EXPECT_NEAR(filter.covariance()(1, 2), 10.0 * 0.25, 1e-6);  // and the gyro's walk
  FusionFilter kept = filter;
  EXPECT_FALSE(kept.decorrelate_unknown_heading(0.75 * 6.25 + 0.01));
  EXPECT_EQ(kept.covariance(), filter.covariance());
  const double across = filter.covariance()(1, 1), yaw = filter.covariance()(2, 2);
  const double bend = 0.75 * std::pow(filter.covariance()(1, 2), 2);
  EXPECT_TRUE(filter.decorrelate_unknown_heading(0.75 * 6.25 - 0.01));
  EXPECT_NEAR(filter.covariance()(1, 1), across + bend, 1e-6);
  EXPECT_EQ(filter.covariance()(1, 2), 0.0);
  EXPECT_EQ(filter.covariance()(2, 2), yaw);
}

}  // namespace
}  // namespace orchard::pose
