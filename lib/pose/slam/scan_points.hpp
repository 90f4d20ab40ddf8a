// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/measurements.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// How base moved from the keyframe to the scan, and moves on while the scan is taken.
struct ScanMotionState {
  Eigen::Vector3d T_keyframe_scan = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// What a scan showed as points where base was at the keyframe, each taken at its own beam's time,
/// with a covariance that says how trunk-like it is: wide, half hidden and odd things have no sharp
/// centre. Leaves out what is too far, too wide or not finite.
std::vector<ScanPoint> scan_points(const SeenTrunks& seen, const ScanMotionState& motion,
                                   const SlamConfig& config);

}  // namespace orchard::pose
