// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/scan_matching/scan_matcher.hpp"

namespace orchard::pose {

/// Returns the covariance of a fit: of (x, y) in map and the rotation about the robot.
///
/// It is computed from the information of the pairs and their residuals. Along each axis the
/// information is limited to the actual loss of fit when the scan is shifted, because in a dense
/// map every point finds a partner nearby, also along a hedge. Undetermined directions keep the
/// covariance of unknown_motion().
Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match);

/// Returns the pose of a fit, with the predicted position in directions that the scan does not
/// determine, if the fit has slid along them, e.g. along a hedge (solution remapping: Zhang, Kaess,
/// Singh 2016).
Eigen::Vector3d remap_pose(const ScanMatch& match, const Eigen::Matrix3d& covariance,
                           const Eigen::Vector3d& T_map_expected);

/// Returns the covariance of a motion that is only predicted.
Eigen::Matrix3d unknown_motion();

}  // namespace orchard::pose
