// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/graph/graph.hpp"

namespace ceres {
class CostFunction;
}

/// Factors of the graph: residuals normalised by their standard deviations, with derivatives.
/// Parameter blocks: a pose is (x, y, yaw) of T_map_base, a landmark (x, y) in map, a calibration
/// an OdometryCalibration. The caller owns the returned objects.
namespace orchard::pose {

/// Scale of the robust (Cauchy) loss: residuals above it are increasingly down-weighted. derived:
/// Gaussian residuals exceed it once in 370.
inline constexpr double kOutlier_sigma = 3.0;

/// Motion between two poses: parameters previous pose, pose, calibration. `covariance` is that of
/// motion.delta, plus that of the previous pose if it is fixed but uncertain.
ceres::CostFunction* motion_factor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);

/// A pose T_map_base with its rotation, computed once for many observations.
struct BasePlacement {
  explicit BasePlacement(const Eigen::Vector3d& T_map_base);

  Eigen::Vector2d p_map;       ///< of base
  Eigen::Matrix2d R_base_map;  ///< from map to base
};

/// Observation of a landmark by a keyframe. No object on the heap: graphs have 100,000 of them.
class ObservationResidual {
 public:
  /// `noise`: the variance of the observation over what it claims.
  explicit ObservationResidual(const SlamObservation& observation, double noise = 1.0);

  Eigen::Vector2d at(const BasePlacement& base, const Eigen::Vector2d& p_map) const {
    return W_ * (seen(base, p_map) - p_base_);
  }
  Eigen::Matrix<double, 2, 3> by_pose(const BasePlacement& base,
                                      const Eigen::Vector2d& p_map) const;
  Eigen::Matrix2d by_position(const BasePlacement& base) const { return W_ * base.R_base_map; }

 private:
  static Eigen::Vector2d seen(const BasePlacement& base, const Eigen::Vector2d& p_map) {
    return base.R_base_map * (p_map - base.p_map);
  }

  Eigen::Vector2d p_base_;
  Eigen::Matrix2d W_;
};

/// Prior on a landmark's position: parameter landmark.
ceres::CostFunction* landmark_prior_factor(const Eigen::Vector2d& p_map,
                                           const Eigen::Matrix2d& covariance);

/// Prior on the odometry calibration: parameter calibration.
ceres::CostFunction* calibration_prior_factor(const OdometryCalibration& mean,
                                              const Eigen::Matrix3d& covariance);

/// Random walk of the odometry calibration between intervals of travel: parameters before, after.
/// `kept` are the decay factors, `sd` the standard deviations of the change.
ceres::CostFunction* calibration_walk_factor(const Eigen::Vector3d& kept,
                                             const Eigen::Vector3d& sd);

/// Absolute position of a point on base: parameter pose.
ceres::CostFunction* absolute_position_factor(const AbsolutePosition& position);

/// Absolute position by GNSS, with the claimed covariance multiplied by `noise`: parameters pose,
/// receiver error.
ceres::CostFunction* receiver_position_factor(const AbsolutePosition& position, double noise);

/// Gauss-Markov transition of a receiver's error: parameters error before, after.
ceres::CostFunction* receiver_error_factor(const ReceiverModel& model, const ReceiverError& before,
                                           const ReceiverError& after);

/// Prior on a receiver's error: parameter error.
ceres::CostFunction* receiver_error_prior_factor(const ReceiverModel& model,
                                                 const ReceiverError& error);

/// Absolute heading: parameter pose.
ceres::CostFunction* heading_factor(const AbsolutePosition& position);

}  // namespace orchard::pose
