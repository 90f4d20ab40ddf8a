// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/graph/motion.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Travel over which the odometry calibration is taken as constant [m]: an interval.
inline constexpr double kCalibrationTravel_m = 10.0;

/// The odometry calibration as known without the observations that are about to be used.
struct CalibrationPrior {
  OdometryCalibration mean = OdometryCalibration::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();

  /// Standard deviations before anything is estimated.
  static Eigen::Vector3d initial_sd(const SlamConfig& config);
  static CalibrationPrior initial(const SlamConfig& config);

  /// What is known of it so many intervals later: in the end what was known at the start.
  CalibrationPrior after(int num_intervals, const Eigen::Vector3d& walk_sd,
                         const SlamConfig& config) const;
};

/// What an interval keeps of the calibration of the one before, of each number: so much that it is
/// as uncertain in the end as it was at the start. Wheels' errors change by `walk_sd` from interval
/// to interval, but do not grow without end.
Eigen::Vector3d kept_calibration(const Eigen::Vector3d& walk_sd, const SlamConfig& config);

/// Standard deviations of the calibration's change from one interval to the next before anything is
/// learnt: wheels' errors change over some tens of metres by as much as is known of them.
Eigen::Vector3d initial_walk_sd(const SlamConfig& config);

/// The calibration's change from one interval to the next by a solved graph.
struct CalibrationStep {
  Eigen::Vector3d change = Eigen::Vector3d::Zero();    ///< against what is kept
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();  ///< of change, given the observations
};

/// The same standard deviations by the steps of a drive that was solved with `walk_sd`: how slip
/// follows ground and curve is this robot's on this ground. Each step counts as far as observations
/// tell it (a straight way tells nothing of turns). Source: MacKay 1992, Bayesian Interpolation,
/// eqs. 4.7-4.10: the evidence's fixed point over well determined parameters.
Eigen::Vector3d learnt_walk_sd(const std::vector<CalibrationStep>& steps,
                               const Eigen::Vector3d& walk_sd, const SlamConfig& config);

}  // namespace orchard::pose
