// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/tracker.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "unit/central_difference.hpp"
#include "unit/pose/prior_map/prior_world.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;
using test::central_difference;

const Eigen::Vector3d kStart(3.0, 2.0, 0.4);

Eigen::Matrix3d start_covariance() {
  const Eigen::Matrix3d A =
      (Eigen::Matrix3d() << 0.1, 0, 0, -0.03, 0.08, 0, 0.01, 0.02, 0.03).finished();
  return A * A.transpose();
}

/// No error of the wheels: what is left is what the call itself states and the map's own error.
PriorMapConfig exact() {
  PriorMapConfig config;
  config.speed_scale_sd = config.turn_scale_sd = config.yaw_rate_bias_sd_radps = 0.0;
  return config;
}

const PriorMap& some_map() {
  static const PriorMap map(prior_world(1).trees, 8.0);
  return map;
}

Eigen::Matrix3d covariance_after(const PriorMapConfig& config, const WheelStep& step,
                                 const Eigen::Matrix3d& before) {
  PriorMapTracker tracker(some_map(), config);
  tracker.start(kStart, before);
  tracker.move(step);
  return tracker.covariance();
}

TEST(PriorMapTracker, MotionCarriesTheCovarianceAsTheCentralDifferencesDo) {
  const WheelStep step{1.3, 0.7, {0.0, 0.0, 0.0}, 0.2};
  const PriorMapTracker still(some_map(), exact());
  const auto by_pose = [&](const Eigen::VectorXd& x) {
    return compose(Eigen::Vector3d(x), still.motion(step));
  };
  const Eigen::MatrixXd F = central_difference(by_pose, kStart).J;
  // The drift by slip is in both, and cancels.
  const Eigen::Matrix3d drift = covariance_after(exact(), step, Eigen::Matrix3d::Zero());
  const Eigen::Matrix3d of_pose = covariance_after(exact(), step, start_covariance()) - drift;
  EXPECT_LT((of_pose - F * start_covariance() * F.transpose()).norm(), 1e-9);

  // The wheels' errors, by what they do to the readings: (1 - s) v, (1 - g) w - b.
  const auto by_errors = [&](const Eigen::VectorXd& e) {
    WheelStep read = step;
    read.speed_mps *= 1.0 - e[0];
    read.yaw_rate_radps = (1.0 - e[1]) * step.yaw_rate_radps - e[2];
    return compose(kStart, still.motion(read));
  };
  const Eigen::MatrixXd E = central_difference(by_errors, Eigen::Vector3d::Zero()).J;
  const Eigen::Vector3d sd(0.03, 0.04, 0.05);
  PriorMapConfig wheels = exact();
  wheels.speed_scale_sd = sd[0];
  wheels.turn_scale_sd = sd[1];
  wheels.yaw_rate_bias_sd_radps = sd[2];
  const Eigen::Matrix3d of_errors = covariance_after(wheels, step, Eigen::Matrix3d::Zero()) - drift;
  EXPECT_LT((of_errors - E * Eigen::Matrix3d(sd.cwiseAbs2().asDiagonal()) * E.transpose()).norm(),
            1e-10);

  // The noise of the readings.
  const auto by_readings = [&](const Eigen::VectorXd& r) {
    return still.motion({r[0], r[1], {}, step.dt_s});
  };
  const Eigen::MatrixXd J =
      central_difference(by_readings, Eigen::Vector2d(step.speed_mps, step.yaw_rate_radps)).J;
  WheelStep noisy = step;
  noisy.covariance = {0.04, 0.01, 0.09};
  const Eigen::Matrix2d Q = (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished();
  EXPECT_LT((still.motion_covariance(noisy) - still.motion_covariance(step) - J * Q * J.transpose())
                .norm(),
            1e-10);
}

TEST(PriorMapTracker, AMeasuredMotionCarriesTheCovarianceAsTheCentralDifferencesDo) {
  const Eigen::Vector3d next(0.8, -0.1, 0.3);
  PriorMapTracker tracker(some_map(), exact());
  tracker.start(kStart, start_covariance());
  tracker.move(next, 0.2 * start_covariance());
  const auto by_pose = [&](const Eigen::VectorXd& x) { return compose(Eigen::Vector3d(x), next); };
  const auto by_motion = [&](const Eigen::VectorXd& x) {
    return compose(kStart, Eigen::Vector3d(x));
  };
  const Eigen::MatrixXd F = central_difference(by_pose, kStart).J;
  const Eigen::MatrixXd G = central_difference(by_motion, next).J;
  EXPECT_LT((tracker.T_map_base() - compose(kStart, next)).norm(), 1e-12);
  EXPECT_LT((tracker.covariance() - F * start_covariance() * F.transpose() -
             G * 0.2 * start_covariance() * G.transpose())
                .norm(),
            1e-9);
}

/// A tree as seen from a pose, off by some centimetres.
ScanObservation seen(const PriorLandmark& tree, const Eigen::Vector3d& T_map_base,
                     const Eigen::Vector2d& off_base_m) {
  ScanObservation observation;
  observation.p_base = geometry::inverse_transform(T_map_base, tree.p_map) + off_base_m;
  observation.covariance << 4e-4, 1e-4, 1e-4, 9e-4;
  return observation;
}

TEST(PriorMapTracker, CorrectsByTheGainOfTheCentralDifferences) {
  const PriorMap map(std::vector<PriorLandmark>{{{6.0, 3.0}}, {{9.0, 9.0}}, {{1.0, 9.0}}}, 20.0);
  PriorMapTracker tracker(map, exact());
  tracker.start(kStart, start_covariance());
  const ScanObservation observation = seen(map[0], kStart, {0.05, -0.03});
  const auto place = [&](const Eigen::VectorXd& x) {
    return geometry::transform(Eigen::Vector3d(x), observation.p_base);
  };
  const Eigen::MatrixXd H = central_difference(place, kStart).J;
  const Eigen::Matrix2d R = geometry::rotation(kStart.z());
  const Eigen::Matrix3d P = start_covariance();
  // The map's own error is met again at each of about ten sightings of a tree.
  const double map_variance = 10.0 * PriorMapConfig::kLandmarkSd_m * PriorMapConfig::kLandmarkSd_m;
  const Eigen::Matrix2d S = H * P * H.transpose() + R * observation.covariance * R.transpose() +
                            map_variance * Eigen::Matrix2d::Identity();
  const Eigen::MatrixXd K = P * H.transpose() * S.inverse();
  const auto matching = tracker.correct({observation}, FieldOfView(4.0));
  ASSERT_EQ(matching.num_matched, 1);
  EXPECT_LT((tracker.T_map_base() - kStart - K * (map[0].p_map - place(kStart))).norm(), 1e-9);
  EXPECT_LT((tracker.covariance() - P + K * S * K.transpose()).norm(), 1e-9);
}

TEST(PriorMapTracker, TakesNoTreeTwiceNoneOfAnotherSizeAndNoneBetweenTwo) {
  const std::vector<PriorLandmark> trees{{{6.0, 3.0}, 0.10},
                                         {{6.0, -1.0}, 0.10},
                                         {{6.0, 7.0}, 0.50},
                                         {{0.0, 3.0}, 0.10},
                                         {{0.0, 3.3}, 0.10}};
  const PriorMap map(trees, 20.0);
  PriorMapConfig config;
  PriorMapTracker tracker(map, config);
  tracker.start(kStart, start_covariance());
  ScanObservation right = seen(trees[0], kStart, {0.01, 0.0});
  right.width_m = 0.10;
  right.width_sd_m = 0.01;
  ScanObservation again = seen(trees[0], kStart, {-0.02, 0.01});
  EXPECT_EQ(tracker.correct({right, again}, FieldOfView(4.0)).num_matched, 1);

  ScanObservation thin = seen(trees[2], kStart, {0.0, 0.0});
  thin.width_m = 0.10;
  thin.width_sd_m = 0.01;
  EXPECT_EQ(tracker.correct({thin}, FieldOfView(4.0)).num_matched, 0);

  PriorLandmark between = trees[3];
  between.p_map.y() = 3.15;
  EXPECT_EQ(tracker.correct({seen(between, kStart, {0.0, 0.0})}, FieldOfView(4.0)).num_matched, 0);
}

TEST(PriorMapTracker, LearnsAWheelScaleFromTheTrees) {
  // Wheels that tell 5 % too much, on a way whose trees stand where the map has them.
  std::vector<PriorLandmark> trees;
  for (int i = 0; i < 12; ++i) {
    for (const double side_m : {-1.5, 1.6}) trees.push_back({{3.0 * i, side_m}});
  }
  const PriorMap map(trees, 8.0);
  PriorMapConfig config;
  PriorMapTracker tracker(map, config);
  tracker.start(Eigen::Vector3d::Zero(), 1e-4 * Eigen::Matrix3d::Identity());
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();
  for (int i = 0; i < 300; ++i) {
    truth.x() += 0.1;
    tracker.move({1.05, 0.0, {1e-4, 0.0, 1e-4}, 0.1});
    std::vector<ScanObservation> observations;
    for (const PriorLandmark& tree : trees) {
      if ((tree.p_map - truth.head<2>()).norm() < 3.5) {
        observations.push_back(seen(tree, truth, {0.0, 0.0}));
      }
    }
    tracker.correct(observations, FieldOfView(4.0));
  }
  EXPECT_LT((tracker.T_map_base() - truth).norm(), 0.03);
  EXPECT_NEAR(tracker.motion({1.05, 0.0, {}, 1.0}).x(), 1.0, 0.005);
  EXPECT_NEAR(tracker.motion({0.0, 0.0, {}, 1.0}).z(), 0.0, 0.002);
}

TEST(PriorMapTracker, TellsWhichTreesShouldHaveBeenSeenAndWhichWere) {
  const std::vector<PriorLandmark> trees{{{2.0, 1.0}}, {{2.0, -1.0}}, {{4.0, 2.0}}, {{30.0, 0.0}}};
  const PriorMap map(trees, 40.0);
  PriorMapTracker tracker(map, PriorMapConfig{});
  tracker.start(Eigen::Vector3d::Zero(), 1e-4 * Eigen::Matrix3d::Identity());
  FieldOfView field(4.0);
  const std::vector<ScanObservation> observations{seen(trees[0], Eigen::Vector3d::Zero(), {0, 0})};
  for (int i = 0; i < 20; ++i) {
    for (double angle_rad = -3.1; angle_rad < 3.1; angle_rad += 0.1) {
      ScanObservation around;
      around.p_base = 3.9 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
      field.learn({around});
    }
  }
  const auto matching = tracker.correct(observations, field);
  EXPECT_EQ(matching.num_matched, 1);
  // Tree 2 stands in line behind tree 0, tree 3 beyond all range.
  ASSERT_EQ(matching.expected.size(), 2u);
  for (const ExpectedLandmark& landmark : matching.expected) {
    EXPECT_EQ(landmark.seen, landmark.landmark == 0);
  }
}

}  // namespace
}  // namespace orchard::pose
