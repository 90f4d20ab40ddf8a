// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/calibration.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

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
