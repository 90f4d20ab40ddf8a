// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

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
