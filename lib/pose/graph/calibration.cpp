// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/calibration.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

// Travel over which the wheels' scales change by their prior standard deviation [m]: slip depends
// on ground and curvature, tyres on temperature and load.
constexpr double kCalibrationChange_m = 50.0;
// The same for the yaw rate bias, which does not depend on the ground.
constexpr double kBiasChange_m = 500.0;
// Avoids division by zero when a prior standard deviation is 0.
constexpr double kSdMin = 1e-9;
// Weight of the initial walk_sd, in steps.
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

}  // namespace orchard::pose
