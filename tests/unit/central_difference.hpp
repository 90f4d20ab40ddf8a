// SPDX-License-Identifier: BSD-3-Clause
// Numeric check of analytic Jacobians. Every one in lib/, where it is checked, and how:
//
// | Jacobian                                            | checked in                              |
// seen by | | --------------------------------------------------- |
// --------------------------------------- | ------- | | geometry/pose2: compose, by both; a point,
// by pose  | geometry/pose2_test                     | itself | | laser/circle_fit: ranges, sides,
// radius; to plane   | laser/circle_fit_test                   | covariance | | pose/arc_motion: by
// speed and yaw rate              | pose/graph/factors_test                 | itself | |
// pose/graph/motion: by the odometry calibration      | pose/graph/factors_test                 |
// itself | | pose/graph/factors: all nine, and observations      | pose/graph/factors_test | itself
// | | pose/graph/joint_covariance: pose and calibration   | pose/graph/factors_test | covariance |
// | pose/compose_covariance (MRPT): both poses          | pose/graph/factors_test                 |
// covariance | | pose/filter/fusion_filter: motion, noise, position  |
// pose/filter/fusion_filter_test          | covariance, gain | | pose/prior_map/tracker: motion,
// noise, observation  | pose/prior_map/tracker_test             | covariance, gain | |
// mapping/compare/map_alignment: pairs                | mapping/compare/map_alignment_test      |
// covariance | | mapping/candidate: a landmark, by the pose          | mapping/mapper_test
// (candidate)         | covariance | | calibration/board/board_pose: corners, by the pose  |
// calibration/board/board_pose_test       | covariance | | calibration/trunks/multinomial_fit:
// slope, Hessian  | calibration/trunks/probability_learner  | optimum, sandwich |
//
// The rest of lib/ composes these, differentiates automatically (ceres, calibration/extrinsics) or
// numerically. Where a Jacobian is private, what is made of it is compared with the same made of
// central differences: a covariance F P F^T, the gain of a correction, a least squares' (J^T J)^-1.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace orchard::test {

/// Derivatives of a function R^n -> R^m by central differences, with the bound of their error.
struct CentralDifference {
  Eigen::MatrixXd J;      ///< m x n
  Eigen::MatrixXd error;  ///< bound of each coefficient's error
};

/// Differentiates f at x by central differences of steps h and 2h. Their error is
/// h^2 f''' / 6 + eps |f| / h; the first term is a third of how far both differ, the second is by
/// rounding. f takes and returns vectors of Eigen; differences must not cross the wrap of an angle.
template <class Function>
CentralDifference central_difference(const Function& f, const Eigen::VectorXd& x, double h = 1e-4) {
  const Eigen::VectorXd at = f(x);
  CentralDifference result{Eigen::MatrixXd(at.size(), x.size()),
                           Eigen::MatrixXd(at.size(), x.size())};
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto slope = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd above = x, below = x;
      above[i] += step;
      below[i] -= step;
      return (Eigen::VectorXd(f(above)) - Eigen::VectorXd(f(below))) / (above[i] - below[i]);
    };
    result.J.col(i) = slope(h);
    // Numbers of the inner terms are larger than f where f is a small difference: at least 1.
    const double rounding = 64.0 * std::numeric_limits<double>::epsilon() *
                            (1.0 + at.cwiseAbs().maxCoeff() + x.cwiseAbs().maxCoeff()) / h;
    result.error.col(i) =
        ((slope(2.0 * h) - result.J.col(i)).cwiseAbs().array() + rounding).matrix();
  }
  return result;
}

/// Expects a Jacobian to be that of f at x. `approximation`: the error that the Jacobian's own
/// comment allows it, 0 for an exact one.
template <class Function, class Matrix>
void expect_jacobian(const Eigen::MatrixBase<Matrix>& analytic, const Function& f,
                     const Eigen::VectorXd& x, double approximation = 0.0, double h = 1e-4) {
  const CentralDifference numeric = central_difference(f, x, h);
  ASSERT_EQ(analytic.rows(), numeric.J.rows());
  ASSERT_EQ(analytic.cols(), numeric.J.cols());
  for (Eigen::Index i = 0; i < analytic.rows(); ++i) {
    for (Eigen::Index j = 0; j < analytic.cols(); ++j) {
      EXPECT_NEAR(analytic(i, j), numeric.J(i, j), numeric.error(i, j) + approximation)
          << "row " << i << ", column " << j;
    }
  }
}

}  // namespace orchard::test
