// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/board/board_pose.hpp"

namespace orchard::calibration {

/// How a board was moved before a camera, as far as it matters for a laser's place.
struct BoardMotion {
  /// Standard deviations of the boards' normals about their plane of largest extent and about
  /// their common direction [1 = 57 deg]: 0 when all lie in a plane; 0 when all are parallel.
  double out_of_plane = 0.0;
  double out_of_line = 0.0;
  Eigen::Vector3d axis_camera = Eigen::Vector3d::UnitY();  ///< that the normals are farthest from
  double tilt_max_deg = 0.0;                               ///< largest angle between two boards
  double distance_min_m = 0.0;                             ///< of the planes
  double distance_max_m = 0.0;
  double moved_m = 0.0;      ///< largest way between two boards' origins
  int num_orientations = 0;  ///< that differ by more than their noise and 6 degrees
};

BoardMotion board_motion(const std::vector<BoardPose>& boards);

/// "its x axis (to the right)": the camera's axis nearest to a direction, or the direction itself.
std::string camera_direction(const Eigen::Vector3d& direction_camera);

/// Why a set of boards cannot fix a laser's place, in words, with what to do; empty when it can.
///
/// A line in a board's plane tells of the translation only its part along the board's normal, so
/// the normals must span space: with all normals in one plane the translation across that plane
/// (and two rotations with it, for an upright board) stays open, with all of them parallel two
/// directions do. Needs no scan.
std::string degenerate_motion(const BoardMotion& motion);

/// Why a mount's covariance (as MountAdjustment has it) is too large to be used: the weakest
/// direction in words; empty when every standard deviation is within the limits.
std::string undetermined_direction(const Eigen::Matrix<double, 6, 6>& covariance,
                                   double shift_sd_max_m, double turn_sd_max_rad,
                                   const BoardMotion& motion);

}  // namespace orchard::calibration
