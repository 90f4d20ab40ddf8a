// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/board/board_pose.hpp"

namespace orchard::calibration {

/// Variety of the board poses, as needed for the observability of the laser-camera extrinsics.
struct BoardMotion {
  /// Standard deviations of the normals about their best plane and about their common direction
  /// [rad]: out_of_plane is 0 when all normals lie in one plane, out_of_line when all are parallel.
  double out_of_plane = 0.0;
  double out_of_line = 0.0;
  Eigen::Vector3d axis_camera = Eigen::Vector3d::UnitY();  ///< axis normal to that best plane
  double tilt_max_deg = 0.0;                               ///< largest angle between two boards
  double distance_min_m = 0.0;                             ///< distances of the board planes
  double distance_max_m = 0.0;
  double moved_m = 0.0;      ///< largest distance between two board origins
  int num_orientations = 0;  ///< number that differ by more than their noise and 6 degrees
};

BoardMotion board_motion(const std::vector<BoardPose>& boards);

/// Describes a direction by the nearest camera axis, such as "its x axis (to the right)", or by its
/// components.
std::string camera_direction(const Eigen::Vector3d& direction_camera);

/// Explains why a set of board poses does not determine the extrinsics, with the remedy; empty when
/// it does.
///
/// A line in a board's plane constrains the translation only along the board's normal, so the
/// normals must span space. If all normals lie in one plane, the translation normal to that plane
/// is undetermined (for an upright board also two rotations); if all are parallel, two directions
/// are. Needs no scan.
std::string degenerate_motion(const BoardMotion& motion);

/// Names the weakest direction if the covariance (as in ExtrinsicsAdjustment) exceeds the limits;
/// empty when every standard deviation is within them.
std::string undetermined_direction(const Eigen::Matrix<double, 6, 6>& covariance,
                                   double shift_sd_max_m, double turn_sd_max_rad,
                                   const BoardMotion& motion);

}  // namespace orchard::calibration
