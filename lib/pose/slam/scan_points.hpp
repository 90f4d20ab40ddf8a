// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "detection/detection.hpp"
#include "pose/measurements.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Motion of base from the keyframe to the scan, and its velocity during the scan.
struct ScanMotionState {
  Eigen::Vector3d T_keyframe_scan = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// The objects of a scan as points in base at the keyframe, each corrected for the motion up to its
/// own beam. Wide, occluded and odd objects have no sharp centre and a large covariance. Leaves out
/// objects that are too far, too wide or not finite.
std::vector<ScanPoint> scan_points(const detection::Detections& seen, const ScanMotionState& motion,
                                   const SlamConfig& config);

}  // namespace orchard::pose
