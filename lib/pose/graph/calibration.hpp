// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "pose/graph/graph.hpp"
#include "pose/motion.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Length of an interval, over which the odometry calibration is constant [m]; derived: a fifth of
/// the travel in which the wheels' scales change.
inline constexpr double kCalibrationTravel_m = 10.0;

/// Prior of the odometry calibration.
struct CalibrationPrior {
  OdometryCalibration mean = OdometryCalibration::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();

  /// Returns the configured standard deviations, before anything is estimated.
  static Eigen::Vector3d initial_sd(const SlamConfig& config);
  static CalibrationPrior initial(const SlamConfig& config);

  /// Predicts the prior by this number of intervals; in the limit it becomes the initial one.
  CalibrationPrior after(int num_intervals, const Eigen::Vector3d& walk_sd,
                         const SlamConfig& config) const;
};

/// Returns the decay factors of the calibration from one interval to the next. They keep its
/// variance stationary at the initial one: the errors change by `walk_sd` per interval but do not
/// grow without bound.
Eigen::Vector3d calibration_decay(const Eigen::Vector3d& walk_sd, const SlamConfig& config);

/// Returns the initial standard deviations of the calibration's change per interval: wheel errors
/// change by as much as their prior over some tens of metres.
Eigen::Vector3d initial_walk_sd(const SlamConfig& config);

/// Change of the calibration from one interval to the next in a solved graph.
struct CalibrationStep {
  Eigen::Vector3d change = Eigen::Vector3d::Zero();    ///< relative to the decayed previous value
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();  ///< of change, given the observations
};

/// Learns the standard deviations of the change per interval from the steps of a drive that was
/// solved with `walk_sd`, because slip depends on the robot and the ground. Each step is weighted
/// by how well the observations determine it (a straight path does not determine turns). Source:
/// MacKay 1992, Bayesian Interpolation, eqs. 4.7-4.10: fixed point of the evidence over the
/// well-determined parameters.
Eigen::Vector3d learnt_walk_sd(const std::vector<CalibrationStep>& steps,
                               const Eigen::Vector3d& walk_sd, const SlamConfig& config);

/// Joint covariance of a pose (x, y, yaw in map) and the odometry calibration of its time, in this
/// order. It keeps the correlation of wheel errors over a hundred metres.
using JointCovariance = Eigen::Matrix<double, 6, 6>;

JointCovariance joint_covariance(const Keyframe& keyframe);
void set_joint_covariance(const JointCovariance& covariance, Keyframe& keyframe);

/// Returns the joint covariance after `motion` from T_map_before; `delta` is the motion with the
/// present calibration.
JointCovariance after_motion(const JointCovariance& before, const Eigen::Vector3d& T_map_before,
                             const RelativeMotion& motion, const Eigen::Vector3d& delta);

/// Indices of the unknowns of a pose and a calibration in an information matrix.
using JointIndices = std::array<int, 6>;

/// Returns the joint covariance of the `wanted` unknowns, given the prior covariance of the `known`
/// ones and the information matrix of the measurements over all unknowns. None if the measurements
/// do not determine the other unknowns.
std::optional<JointCovariance> after_measurements(const JointCovariance& prior,
                                                  const Eigen::MatrixXd& information,
                                                  const JointIndices& known,
                                                  const JointIndices& wanted);

}  // namespace orchard::pose
