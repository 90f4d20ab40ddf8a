// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// One fix: where the antenna was in the datum's east-north plane, and where the map has it.
struct AntennaObservation {
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  double variance_m2 = 1.0;  ///< of the fix, per axis
};

/// How a map lies in the datum's east-north plane.
struct GnssAlignment {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();  ///< T_enu_map
  double residual_rms_m = 0.0;                        ///< of the fixes that were kept
  int num_used = 0;
  int num_left_out = 0;  ///< jumps and the like
};

/// The rigid transform that lays the robot's path in map upon its satellite fixes, weighted by
/// their variance, outliers left out (farther off than four times the median). None for fewer
/// than ten fixes, or when they spread too little to show a heading: less than 5 m, or than
/// twenty times what their scatter leaves of it.
std::optional<GnssAlignment> align_to_gnss(const std::vector<AntennaObservation>& observations);

}  // namespace orchard::pose
