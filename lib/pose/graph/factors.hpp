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

/// Normalised residual from which on the robust loss of an observation is linear.
inline constexpr double kOutlier_sigma = 3.0;

/// Motion between two poses: parameters pose before, pose, calibration. `covariance` is of
/// motion.delta, perhaps with that of a fixed pose before.
ceres::CostFunction* motion_factor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);

/// Observation of a landmark by a keyframe: parameters pose, landmark.
ceres::CostFunction* observation_factor(const SlamObservation& observation);

/// The same without an object of the caller's: a graph has a hundred thousand of them.
class ObservationResidual {
 public:
  explicit ObservationResidual(const SlamObservation& observation);

  Eigen::Vector2d at(const Eigen::Vector3d& T_map_base, const Eigen::Vector2d& p_map) const {
    return W_ * (seen(T_map_base, p_map) - p_base_);
  }
  Eigen::Matrix<double, 2, 3> by_pose(const Eigen::Vector3d& T_map_base,
                                      const Eigen::Vector2d& p_map) const;
  Eigen::Matrix2d by_position(const Eigen::Vector3d& T_map_base) const;

 private:
  static Eigen::Vector2d seen(const Eigen::Vector3d& T_map_base, const Eigen::Vector2d& p_map);

  Eigen::Vector2d p_base_;
  Eigen::Matrix2d W_;
};

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

/// What is left of a receiver's error when the next one begins: parameters error before, after.
ceres::CostFunction* receiver_error_factor(const ReceiverModel& model, const ReceiverError& before,
                                           const ReceiverError& after);

/// Prior on a receiver's error: parameter error.
ceres::CostFunction* receiver_error_prior_factor(const ReceiverModel& model,
                                                 const ReceiverError& error);

/// Absolute heading: parameter pose.
ceres::CostFunction* heading_factor(const AbsolutePosition& position);

}  // namespace orchard::pose
