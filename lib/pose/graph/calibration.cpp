// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/calibration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

// Travel over which the wheels' scales and the yaw rate bias change by their prior standard
// deviation [m]. physical: slip depends on ground and curvature, tyres on temperature and load; the
// bias does not depend on the ground.
constexpr double kCalibrationChange_m = 50.0;
constexpr double kBiasChange_m = 500.0;
// derived: no division by a prior of 0; the initial walk_sd counts as one step.
constexpr double kSdMin = 1e-9;
constexpr double kPriorSteps = 1.0;

}  // namespace

Eigen::Vector3d CalibrationPrior::initial_sd(const SlamConfig& config) {
  return {config.speed_scale_sd, config.turn_scale_sd, config.yaw_rate_bias_sd_radps};
}

CalibrationPrior CalibrationPrior::initial(const SlamConfig& config) {
  CalibrationPrior prior;
  prior.covariance = initial_sd(config).array().square().matrix().asDiagonal();
  return prior;
}

CalibrationPrior CalibrationPrior::after(int num_intervals, const Eigen::Vector3d& walk_sd,
                                         const SlamConfig& config) const {
  const Eigen::Array3d kept = calibration_decay(walk_sd, config).array().pow(num_intervals);
  CalibrationPrior later;
  later.mean = (kept * mean.array()).matrix();
  later.covariance = kept.matrix().asDiagonal() * covariance * kept.matrix().asDiagonal();
  later.covariance.diagonal() +=
      ((1.0 - kept.square()) * initial_sd(config).array().square()).matrix();
  return later;
}

Eigen::Vector3d calibration_decay(const Eigen::Vector3d& walk_sd, const SlamConfig& config) {
  const Eigen::Array3d fraction =
      walk_sd.array() / (CalibrationPrior::initial_sd(config).array() + kSdMin);
  return (1.0 - fraction.square()).max(0.0).sqrt().matrix();
}

Eigen::Vector3d initial_walk_sd(const SlamConfig& config) {
  Eigen::Vector3d sd = CalibrationPrior::initial_sd(config);
  sd.head<2>() *= std::sqrt(kCalibrationTravel_m / kCalibrationChange_m);
  sd.z() *= std::sqrt(kCalibrationTravel_m / kBiasChange_m);
  return sd;
}

Eigen::Vector3d learnt_walk_sd(const std::vector<CalibrationStep>& steps,
                               const Eigen::Vector3d& walk_sd, const SlamConfig& config) {
  const Eigen::Array3d prior2 = walk_sd.array().square().max(1e-18);
  Eigen::Array3d sum2 = kPriorSteps * initial_walk_sd(config).array().square();
  Eigen::Array3d num = Eigen::Array3d::Constant(kPriorSteps);
  for (const CalibrationStep& step : steps) {
    if (!step.change.allFinite() || !step.variance.allFinite()) continue;
    sum2 += step.change.array().square();
    num += (1.0 - step.variance.array() / prior2).max(0.0).min(1.0);
  }
  return (sum2 / num).sqrt().matrix();
}

JointCovariance joint_covariance(const Keyframe& keyframe) {
  JointCovariance P;
  P << keyframe.covariance, keyframe.calibration_cross, keyframe.calibration_cross.transpose(),
      keyframe.calibration_covariance;
  return P;
}

void set_joint_covariance(const JointCovariance& covariance, Keyframe& keyframe) {
  keyframe.covariance = covariance.topLeftCorner<3, 3>();
  keyframe.calibration_cross = covariance.topRightCorner<3, 3>();
  keyframe.calibration_covariance = covariance.bottomRightCorner<3, 3>();
}

JointCovariance after_motion(const JointCovariance& before, const Eigen::Vector3d& T_map_before,
                             const RelativeMotion& motion, const Eigen::Vector3d& delta) {
  const Eigen::Matrix3d G = geometry::compose_jacobian_second(T_map_before);
  JointCovariance F = JointCovariance::Identity();
  F.topLeftCorner<3, 3>() = geometry::compose_jacobian_first(T_map_before, delta);
  F.topRightCorner<3, 3>() = G * motion.calibration_jacobian;
  JointCovariance P = F * before * F.transpose();
  P.topLeftCorner<3, 3>() += G * motion.covariance * G.transpose();
  return 0.5 * (P + P.transpose());
}

std::optional<JointCovariance> after_measurements(const JointCovariance& prior,
                                                  const Eigen::MatrixXd& information,
                                                  const JointIndices& known,
                                                  const JointIndices& wanted) {
  std::vector<int> rest;
  for (int i = 0; i < static_cast<int>(information.rows()); ++i) {
    if (std::find(known.begin(), known.end(), i) == known.end()) rest.push_back(i);
  }
  const Eigen::MatrixXd H_rest = information(rest, rest);
  const Eigen::MatrixXd H_cross = information(rest, known);
  const Eigen::LLT<Eigen::MatrixXd> factor(H_rest);
  if (factor.info() != Eigen::Success) return std::nullopt;
  // Condition the rest on the known unknowns (gain `follows`); `told` is the information of the
  // measurements on the known ones after marginalising the rest.
  const Eigen::MatrixXd follows = -factor.solve(H_cross);
  const JointCovariance told = information(known, known) + H_cross.transpose() * follows;
  const JointCovariance known_then =
      (JointCovariance::Identity() + prior * told).partialPivLu().solve(prior);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rest.size()), 6);
  for (int w = 0; w < 6; ++w) {
    const auto is_known = std::find(known.begin(), known.end(), wanted[w]);
    if (is_known != known.end()) {
      A(w, is_known - known.begin()) = 1.0;
      continue;
    }
    const auto at = std::find(rest.begin(), rest.end(), wanted[w]) - rest.begin();
    A.row(w) = follows.row(at);
    unit(at, w) = 1.0;
  }
  const JointCovariance own = unit.transpose() * factor.solve(unit);
  const JointCovariance P = A * known_then * A.transpose() + own;
  if (!P.allFinite()) return std::nullopt;
  return JointCovariance(0.5 * (P + P.transpose()));
}

}  // namespace orchard::pose
