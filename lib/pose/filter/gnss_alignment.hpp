// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// Positions of the antenna at one fix: measured in the datum's east-north plane, and estimated in
/// map.
struct AntennaObservation {
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  double variance_m2 = 1.0;  ///< of the fix, per axis
};

/// Pose of a map in the datum's east-north plane.
struct GnssAlignment {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();  ///< T_enu_map
  double residual_rms_m = 0.0;                        ///< of the fixes used
  int num_used = 0;
  int num_left_out = 0;  ///< outliers, e.g. jumps
};

/// Finds the rigid transform that registers the robot's path in map to its satellite fixes,
/// weighted by inverse variance and without outliers (residuals above four times the median and
/// three standard deviations). None for fewer than ten fixes, or if they spread too little to
/// determine a heading: by less than 5 m, or than twenty standard errors of their mean.
std::optional<GnssAlignment> align_to_gnss(const std::vector<AntennaObservation>& observations);

}  // namespace orchard::pose
