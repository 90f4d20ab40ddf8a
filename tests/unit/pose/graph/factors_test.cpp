// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/factors.hpp"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <memory>

#include "geometry/pose2.hpp"
#include "pose/graph/calibration.hpp"
#include "pose/motion.hpp"
#include "unit/central_difference.hpp"

namespace orchard::pose {
namespace {

using test::central_difference;
using test::expect_jacobian;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Residuals of a factor at its stacked parameters.
Eigen::VectorXd residuals_at(const ceres::CostFunction& factor, const Eigen::VectorXd& stacked) {
  std::vector<const double*> blocks;
  const double* next = stacked.data();
  for (const int size : factor.parameter_block_sizes()) {
    blocks.push_back(next);
    next += size;
  }
  Eigen::VectorXd residuals(factor.num_residuals());
  EXPECT_TRUE(factor.Evaluate(blocks.data(), residuals.data(), nullptr));
  return residuals;
}

/// Checks every block of a factor's Jacobian, all blocks asked for and each alone.
void check(const char* name, ceres::CostFunction* made, const Eigen::VectorXd& stacked) {
  SCOPED_TRACE(name);
  const std::unique_ptr<ceres::CostFunction> factor(made);
  const std::vector<int>& sizes = factor->parameter_block_sizes();
  std::vector<const double*> blocks;
  std::vector<RowMajor> jacobians;
  Eigen::Index size = 0;
  for (const int columns : sizes) {
    blocks.push_back(stacked.data() + size);
    jacobians.push_back(RowMajor::Constant(factor->num_residuals(), columns, 1e9));
    size += columns;
  }
  ASSERT_EQ(size, stacked.size());
  std::vector<double*> wanted;
  for (RowMajor& J : jacobians) wanted.push_back(J.data());
  Eigen::VectorXd residuals(factor->num_residuals());
  ASSERT_TRUE(factor->Evaluate(blocks.data(), residuals.data(), wanted.data()));
  RowMajor all(factor->num_residuals(), size);
  size = 0;
  for (const RowMajor& J : jacobians) {
    all.middleCols(size, J.cols()) = J;
    size += J.cols();
  }
  expect_jacobian(
      all, [&](const Eigen::VectorXd& x) { return residuals_at(*factor, x); }, stacked);
  for (std::size_t i = 0; i < jacobians.size(); ++i) {
    const RowMajor together = jacobians[i];
    jacobians[i].setZero();
    std::vector<double*> only(jacobians.size(), nullptr);
    only[i] = jacobians[i].data();
    ASSERT_TRUE(factor->Evaluate(blocks.data(), residuals.data(), only.data()));
    EXPECT_EQ(jacobians[i], together) << "block " << i;
  }
}

Eigen::Matrix3d pose_covariance() {
  const Eigen::Matrix3d A =
      (Eigen::Matrix3d() << 0.3, 0, 0, -0.1, 0.2, 0, 0.05, 0.02, 0.1).finished();
  return A * A.transpose();
}

Eigen::Matrix2d point_covariance() {
  return (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.02).finished();
}

RelativeMotion weave(const OdometryCalibration& calibration) {
  RelativeMotion motion;
  motion.calibration = calibration;
  for (int i = 0; i < 50; ++i) motion.drive(1.0, i < 25 ? 0.4 : -0.3, {0.01, 0.002, 0.01}, 0.02);
  return motion;
}

template <class... Blocks>
Eigen::VectorXd stacked(const Blocks&... blocks) {
  Eigen::VectorXd all((blocks.size() + ...));
  Eigen::Index at = 0;
  ((all.segment(at, blocks.size()) = blocks, at += blocks.size()), ...);
  return all;
}

const Eigen::Vector3d kPose(3.0, -2.0, 2.5), kNext(3.9, -1.1, 2.9);
const OdometryCalibration kCalibration(0.02, -0.03, 0.004);

TEST(Factors, JacobiansAreTheCentralDifferences) {
  check("motion", motion_factor(weave(OdometryCalibration::Zero()), pose_covariance()),
        stacked(kPose, kNext, kCalibration));
  check("landmark prior", landmark_prior_factor({1.0, 2.0}, point_covariance()),
        Eigen::Vector2d(1.3, 1.9));
  check("calibration prior",
        calibration_prior_factor(OdometryCalibration(0.01, 0.0, 0.001), pose_covariance()),
        kCalibration);
  check("calibration walk", calibration_walk_factor({0.9, 0.8, 0.7}, {0.1, 0.2, 0.05}),
        stacked(kCalibration, OdometryCalibration(0.01, -0.02, 0.003)));
  AbsolutePosition position;
  position.T_keyframe_then = {0.4, 0.1, 0.3};
  position.lever_base_m = {0.7, -0.2};
  position.p_map = {3.2, -1.7};
  position.covariance = point_covariance();
  position.has_yaw = true;
  position.yaw_rad = 2.6;
  position.yaw_sd_rad = 0.05;
  check("absolute position", absolute_position_factor(position), kPose);
  check("receiver position", receiver_position_factor(position, 0.6),
        stacked(kPose, Eigen::Vector2d(0.3, -0.4)));
  check("heading", heading_factor(position), kPose);
  ReceiverModel model;
  model.correlated = 0.5;
  ReceiverError before, after;
  before.claimed_variance = after.claimed_variance = 0.04;
  after.utime = 20'000'000;
  check("receiver error", receiver_error_factor(model, before, after),
        Eigen::Vector4d(0.3, -0.4, 0.2, -0.1));
  check("receiver error prior", receiver_error_prior_factor(model, before),
        Eigen::Vector2d(0.3, -0.4));
}

TEST(Factors, JacobiansOfAnObservationAreTheCentralDifferences) {
  SlamObservation observation;
  observation.num_scans = 3;
  observation.information = point_covariance().inverse();
  observation.information_m = observation.information * Eigen::Vector2d(2.0, 1.0);
  observation.floor_sd_m = 0.02;
  const ObservationResidual residual(observation);
  const Eigen::Vector2d p_map(1.2, -0.4);
  const BasePlacement base(kPose);
  expect_jacobian(
      residual.by_pose(base, p_map),
      [&](const Eigen::VectorXd& x) {
        return residual.at(BasePlacement(Eigen::Vector3d(x)), p_map);
      },
      kPose);
  expect_jacobian(
      residual.by_position(base),
      [&](const Eigen::VectorXd& x) { return residual.at(base, Eigen::Vector2d(x)); }, p_map);
}

// Its comment promises the first order of the turn: what is left is the second.
TEST(ArcMotion, JacobianIsTheCentralDifferenceToFirstOrderOfTheTurn) {
  for (const double dt_s : {0.02, 0.1}) {
    for (const double rate_radps : {0.0, 0.3, -0.9}) {
      const double speed_mps = 1.4, turn_rad = rate_radps * dt_s;
      const double left_m = dt_s * turn_rad * turn_rad * std::max(1.0, speed_mps * dt_s) / 12.0;
      expect_jacobian(
          arc_jacobian(speed_mps, rate_radps, dt_s),
          [&](const Eigen::VectorXd& x) { return arc_motion(x[0], x[1], dt_s); },
          Eigen::Vector2d(speed_mps, rate_radps),
          left_m + std::abs(turn_rad) * speed_mps * dt_s * dt_s / 12.0);
    }
  }
}

TEST(RelativeMotion, JacobianByTheCalibrationIsTheCentralDifference) {
  // Each of 50 steps turns by 0.008 rad at most, whose square is left out.
  expect_jacobian(
      weave(kCalibration).calibration_jacobian,
      [](const Eigen::VectorXd& x) { return weave(OdometryCalibration(x)).delta; }, kCalibration,
      1e-5);
}

/// Covariance of f(x) to first order, by central differences.
template <class Function>
Eigen::MatrixXd propagated(const Function& f, const Eigen::VectorXd& x, const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd J = central_difference(f, x).J;
  return J * P * J.transpose();
}

TEST(ComposeCovariance, IsThatOfTheCentralDifferences) {
  const Eigen::Vector3d T_b_c(1.5, 0.7, -1.2);
  const Eigen::Matrix3d P_ab = pose_covariance(), P_bc = 0.3 * pose_covariance().inverse();
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(6, 6);
  P.topLeftCorner<3, 3>() = P_ab;
  P.bottomRightCorner<3, 3>() = P_bc;
  const auto composed = [](const Eigen::VectorXd& x) {
    return geometry::compose(Eigen::Vector3d(x.head<3>()), Eigen::Vector3d(x.tail<3>()));
  };
  const Eigen::MatrixXd expected = propagated(composed, stacked(kPose, T_b_c), P);
  EXPECT_LT((compose_covariance(kPose, P_ab, T_b_c, P_bc) - expected).norm(),
            1e-8 * expected.norm());
}

TEST(JointCovariance, AfterAMotionIsThatOfTheCentralDifferences) {
  const RelativeMotion motion = weave(OdometryCalibration::Zero());
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) root(i, j) = 0.1 * (1 + i) - 0.07 * j;
  }
  const JointCovariance before = root * root.transpose();
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(9, 9);
  P.topLeftCorner<6, 6>() = before;
  P.bottomRightCorner<3, 3>() = motion.covariance;
  // Pose, calibration and the error of the motion, to the pose after it and the calibration.
  const auto moved = [&](const Eigen::VectorXd& x) {
    const Eigen::Vector3d delta =
        motion.delta_with(OdometryCalibration(x.segment<3>(3))) + x.tail<3>();
    return stacked(geometry::compose(Eigen::Vector3d(x.head<3>()), delta),
                   Eigen::Vector3d(x.segment<3>(3)));
  };
  const Eigen::MatrixXd expected = propagated(
      moved, stacked(Eigen::Vector3d(3.0, -2.0, 1.5), motion.calibration, Eigen::Vector3d::Zero()),
      P);
  const JointCovariance after =
      after_motion(before, Eigen::Vector3d(3.0, -2.0, 1.5), motion, motion.delta);
  EXPECT_LT((after - expected).norm(), 1e-7 * expected.norm());
}

}  // namespace
}  // namespace orchard::pose
