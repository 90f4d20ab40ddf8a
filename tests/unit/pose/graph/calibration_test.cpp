// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

/// A calibration that walks, observed in some intervals only.
struct Drive {
  std::vector<double> seen;
  std::vector<double> seen_sd;  ///< of each; 0 = not observed
};

Drive drive(std::uint64_t seed, double walk_sd, int num_intervals) {
  simulation::Random random(seed, simulation::Stream::kOdometry);
  Drive drive;
  double value = 0.0;
  for (int i = 0; i < num_intervals; ++i) {
    const double sd = i % 3 == 0 ? 0.0 : 0.01;  // each third interval is straight
    drive.seen.push_back(value + random.normal(0.0, sd));
    drive.seen_sd.push_back(sd);
    value += random.normal(0.0, walk_sd);
  }
  return drive;
}

/// The steps of the smoothed calibration, by dense linear algebra; every component is the same.
std::vector<CalibrationStep> smoothed(const Drive& drive, double walk_sd) {
  const int n = static_cast<int>(drive.seen.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  H(0, 0) = 1.0;
  for (int i = 0; i < n; ++i) {
    const double sd = drive.seen_sd[static_cast<std::size_t>(i)];
    if (sd > 0.0) {
      H(i, i) += 1.0 / (sd * sd);
      b[i] += drive.seen[static_cast<std::size_t>(i)] / (sd * sd);
    }
    if (i == 0) continue;
    const double w = 1.0 / (walk_sd * walk_sd);
    H(i, i) += w;
    H(i - 1, i - 1) += w;
    H(i, i - 1) -= w;
    H(i - 1, i) -= w;
  }
  const Eigen::MatrixXd P = H.inverse();
  const Eigen::VectorXd x = P * b;
  std::vector<CalibrationStep> steps;
  for (int i = 1; i < n; ++i) {
    CalibrationStep step;
    step.change.setConstant(x[i] - x[i - 1]);
    step.variance.setConstant(P(i, i) + P(i - 1, i - 1) - 2.0 * P(i, i - 1));
    steps.push_back(step);
  }
  return steps;
}

TEST(LearntWalk, FindsHowMuchTheWheelsErrorsChangeFromAnyStart) {
  const SlamConfig config;
  const Eigen::Vector3d start = initial_walk_sd(config);
  for (const double truth : {0.01, 0.04}) {
    double sum = 0.0;
    constexpr int kSeeds = 10;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Drive told = drive(seed, truth, 120);
      Eigen::Vector3d walk_sd = start;
      for (int round = 0; round < 15; ++round) {
        walk_sd = learnt_walk_sd(smoothed(told, walk_sd.y()), walk_sd, config);
      }
      EXPECT_NEAR(walk_sd.y(), truth, 0.5 * truth) << "seed " << seed;
      sum += walk_sd.y();
    }
    EXPECT_NEAR(sum / kSeeds, truth, 0.3 * truth);  // what was believed first still counts a step
  }
}

TEST(LearntWalk, IsWhatWasBelievedWhereNothingTells) {
  const SlamConfig config;
  const Eigen::Vector3d start = initial_walk_sd(config);
  CalibrationStep untold;
  untold.variance = start.array().square().matrix();
  const Eigen::Vector3d walk_sd =
      learnt_walk_sd(std::vector<CalibrationStep>(100, untold), start, config);
  EXPECT_LT((walk_sd - start).norm(), 1e-12);
}

TEST(CalibrationPrior, GrowsWithTheIntervalsToWhatIsKnownAtTheStartAtMost) {
  const SlamConfig config;
  const Eigen::Vector3d walk_sd(0.01, 0.02, 0.001);
  CalibrationPrior now;
  now.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  EXPECT_NEAR(now.after(4, walk_sd, config).covariance(1, 1), 1e-6 + 4 * 0.0004, 2e-4);
  EXPECT_NEAR(now.after(100000, walk_sd, config).covariance(1, 1),
              config.turn_scale_sd * config.turn_scale_sd, 1e-9);
}

Eigen::MatrixXd random_matrix(int rows, int columns, simulation::Random& random) {
  Eigen::MatrixXd M(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) M(i, j) = random.normal();
  }
  return M;
}

TEST(JointCovariance, IsThatOfAllMeasurementsTogether) {
  simulation::Random random(1, simulation::Stream::kScene);
  constexpr int kUnknowns = 15;
  const Eigen::MatrixXd J = random_matrix(20, kUnknowns, random);
  const Eigen::MatrixXd information = J.transpose() * J;
  const Eigen::MatrixXd root = random_matrix(6, 6, random);
  const JointCovariance prior = root * root.transpose();
  const JointIndices known{0, 1, 2, 9, 10, 11};
  // the wanted calibration may be that of the known one, or another
  for (const JointIndices& wanted :
       {JointIndices{6, 7, 8, 12, 13, 14}, JointIndices{6, 7, 8, 9, 10, 11}}) {
    const auto P = after_measurements(prior, information, known, wanted);
    ASSERT_TRUE(P);
    Eigen::MatrixXd all = information;
    const JointCovariance known_information = prior.inverse();
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) all(known[i], known[j]) += known_information(i, j);
    }
    const Eigen::MatrixXd covariance = all.inverse();
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) EXPECT_NEAR((*P)(i, j), covariance(wanted[i], wanted[j]), 1e-9);
    }
  }
}

TEST(JointCovariance, AScaleThatIsOffIsOneErrorNotMany) {
  // By a scale of 1 +- 0.01 a hundred steps of a metre are a hundred metres +- 1, not +- 0.1.
  JointCovariance P = JointCovariance::Zero();
  P(3, 3) = 0.01 * 0.01;
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  for (int step = 0; step < 100; ++step) {
    RelativeMotion motion;
    motion.drive(1.0, 0.0, {0.0, 0.0, 0.0}, 1.0);
    P = after_motion(P, T, motion, motion.delta);
    T = geometry::compose(T, motion.delta);
  }
  EXPECT_NEAR(std::sqrt(P(0, 0)), 1.0, 1e-9);
}

}  // namespace
}  // namespace orchard::pose
