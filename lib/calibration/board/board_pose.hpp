// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"

namespace orchard::calibration {

/// Where a flat board is in the camera frame, and how well that is known.
struct BoardPose {
  Eigen::Matrix3d R_camera_board = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_camera_board_m = Eigen::Vector3d::Zero();  ///< the board's origin
  /// Of (turn about the camera's x, y, z [rad], shift of the origin [m]): the true pose is
  /// exp(turn) R, t + shift.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_px = 0.0;              ///< of the corners, both coordinates
  int num_corners = 0;              ///< that it rests on
  double second_squares_px2 = 0.0;  ///< what the other tilt that a plane allows adds to the squares
  bool ambiguous = false;           ///< a second tilt explains the corners nearly as well

  /// The board's plane: normal_camera . p_camera = distance_m, distance_m > 0.
  Eigen::Vector3d normal_camera() const;
  double distance_m() const;
};

/// The pose of a board (z = 0, positions in metres) from its corners in a picture [px].
///
/// corner_sd_px is the noise of a corner in one coordinate; the covariance rests on it. None for
/// fewer than 6 corners, for sizes that differ, and when no pose in front of the camera explains
/// the corners.
std::optional<BoardPose> estimate_board_pose(const std::vector<Eigen::Vector2d>& corners_px,
                                             const std::vector<Eigen::Vector2d>& corners_m,
                                             const geometry::CameraModel& camera,
                                             double corner_sd_px);

/// The poses of one kind of board in several pictures; the corners' noise is taken from what they
/// leave over in all pictures together. None for pictures without a pose.
std::vector<std::optional<BoardPose>> estimate_board_poses(const std::vector<BoardView>& views,
                                                           const geometry::CameraModel& camera);

}  // namespace orchard::calibration
