// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "detection/detection.hpp"
#include "pose/measurements.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Motion of base from the keyframe to the scan, and the velocity of base during the scan.
struct ScanMotionState {
  Eigen::Vector3d T_keyframe_scan = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Converts the objects of a scan to points in base at the keyframe, each corrected for the motion
/// up to its own beam. Wide or occluded objects and those labelled kObject get a larger covariance
/// because their centre is ill-defined. Objects too far away, too wide or not finite are left out.
std::vector<ScanPoint> scan_points(const detection::Detections& seen, const ScanMotionState& motion,
                                   const SlamConfig& config);

}  // namespace orchard::pose
