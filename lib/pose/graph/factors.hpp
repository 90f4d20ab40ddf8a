// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/graph/graph.hpp"

namespace ceres {
class CostFunction;
}

/// The factors of the graph: residuals in standard deviations, with their derivatives. Parameters:
/// poses are (x, y, yaw) of T_map_base, landmarks (x, y) in map, calibrations three numbers. The
/// caller owns the returned object.
namespace orchard::pose {

/// Motion between two poses: parameters pose before, pose, calibration. `covariance` is of
/// motion.delta, perhaps with that of a fixed pose before.
ceres::CostFunction* motion_factor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);

/// Observation of a landmark by a keyframe: parameters pose, landmark.
ceres::CostFunction* observation_factor(const SlamObservation& observation);

/// Prior on a landmark's position: parameter landmark.
ceres::CostFunction* landmark_prior_factor(const Eigen::Vector2d& p_map,
                                           const Eigen::Matrix2d& covariance);

/// Prior on the odometry calibration: parameter calibration.
ceres::CostFunction* calibration_prior_factor(const OdometryCalibration& mean,
                                              const Eigen::Matrix3d& covariance);

/// Random walk of the odometry calibration between intervals of travel: parameters before, after;
/// what is kept of it, standard deviations of what is new.
ceres::CostFunction* calibration_walk_factor(const Eigen::Vector3d& kept,
                                             const Eigen::Vector3d& sd);

/// Absolute position of a point on base: parameter pose.
ceres::CostFunction* absolute_position_factor(const AbsolutePosition& position);

/// The same by satellites, claims replaced by this noise: parameters pose, the receiver's error.
ceres::CostFunction* receiver_position_factor(const AbsolutePosition& position, double noise);

/// What is left of a receiver's error after a while: parameters error before, after; `kept` of it,
/// standard deviation of what is new.
ceres::CostFunction* receiver_error_factor(double kept, double sd_m);

/// Prior on a receiver's error: parameter error.
ceres::CostFunction* receiver_error_prior_factor(double sd_m);

/// Absolute heading: parameter pose.
ceres::CostFunction* heading_factor(const AbsolutePosition& position);

}  // namespace orchard::pose
