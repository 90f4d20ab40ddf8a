// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Of a pose (x, y, yaw in map) and the odometry calibration of its time, in this order: the errors
/// of wheels last, so that what they add over a hundred metres is one error, not many.
using JointCovariance = Eigen::Matrix<double, 6, 6>;

JointCovariance joint_covariance(const Keyframe& keyframe);
void set_joint_covariance(const JointCovariance& covariance, Keyframe& keyframe);

/// That of a pose reached by `motion` from T_map_before; delta is the motion by the calibration.
JointCovariance after_motion(const JointCovariance& before, const Eigen::Vector3d& T_map_before,
                             const RelativeMotion& motion, const Eigen::Vector3d& delta);

/// Indices of a pose's and a calibration's unknowns.
using JointIndices = std::array<int, 6>;

/// That of the `wanted` unknowns, where `prior` is known of `known` ones, and measurements gave the
/// information matrix of all of them. None where they do not determine the rest.
std::optional<JointCovariance> after_measurements(const JointCovariance& prior,
                                                  const Eigen::MatrixXd& information,
                                                  const JointIndices& known,
                                                  const JointIndices& wanted);

}  // namespace orchard::pose
