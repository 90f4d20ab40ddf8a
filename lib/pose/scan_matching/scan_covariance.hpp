// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/scan_matching/scan_matcher.hpp"

namespace orchard::pose {

/// Covariance of a fit: of (x, y) in map and the turn about the robot.
///
/// From the pairs' information and what is left between them, reduced to what moving the scan to
/// and fro really changes: a dense map offers every point a partner nearby, also along a hedge.
/// What the scan does not tell stays as uncertain as the motion was before it.
Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match);

/// The place of a fit, but where the scan does not tell (along a hedge the fit slides) the expected
/// one (solution remapping: Zhang, Kaess, Singh 2016).
Eigen::Vector3d place_of(const ScanMatch& match, const Eigen::Matrix3d& covariance,
                         const Eigen::Vector3d& T_map_expected);

/// The covariance of a motion of which nothing is known but what was expected.
Eigen::Matrix3d unknown_motion();

}  // namespace orchard::pose
