// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// A satellite fix beside the scanner's pose of its time.
struct AntennaView {
  Eigen::Vector3d T_path_laser = Eigen::Vector3d::Zero();  ///< on the path of matched scans
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();       ///< of the antenna
};

/// Where the antenna is.
struct AntennaEstimate {
  Eigen::Vector2d p_laser_m = Eigen::Vector2d::Zero();  ///< in the laser frame
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  int num_fixes = 0;
};

/// Finds the antenna by registering stretches of path (each consistent in itself, with enough
/// fixes) to their fixes: only while turning the antenna moves unlike the scanner. A receiver's
/// slow error only moves a stretch. None for fewer than twenty fixes, or if nothing determines it.
std::optional<AntennaEstimate> estimate_antenna(
    const std::vector<std::vector<AntennaView>>& stretches);

}  // namespace orchard::pose
