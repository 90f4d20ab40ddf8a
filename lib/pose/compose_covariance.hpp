// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::pose {

/// Covariance of T_a_b * T_b_c, all as (x [m], y [m], yaw [rad]), if the errors of the two are
/// independent; symmetric.
Eigen::Matrix3d compose_covariance(const Eigen::Vector3d& T_a_b, const Eigen::Matrix3d& P_ab,
                                   const Eigen::Vector3d& T_b_c, const Eigen::Matrix3d& P_bc);

}  // namespace orchard::pose
