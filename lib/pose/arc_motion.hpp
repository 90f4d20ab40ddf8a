// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::pose {

/// Returns the exact motion T_before_after of base (x [m], y [m], yaw [rad]) over dt_s at constant
/// speed and yaw rate: an arc.
Eigen::Vector3d arc_motion(double speed_mps, double yaw_rate_radps, double dt_s);

/// Returns d(arc_motion) / d(speed, yaw rate), to first order in the turn: accurate enough to
/// propagate the noise of one interval.
Eigen::Matrix<double, 3, 2> arc_jacobian(double speed_mps, double yaw_rate_radps, double dt_s);

}  // namespace orchard::pose
