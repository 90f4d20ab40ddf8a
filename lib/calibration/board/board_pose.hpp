// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"

namespace orchard::calibration {

/// Pose of a board in the camera frame, with covariance.
struct BoardPose {
  Eigen::Matrix3d R_camera_board = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_camera_board_m = Eigen::Vector3d::Zero();  ///< the board's origin
  /// Covariance of (rotation about the camera's x, y, z [rad], shift of the origin [m]): the true
  /// pose is exp(rotation) R, t + shift.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_px = 0.0;  ///< RMS residual of the corners, both coordinates
  int num_corners = 0;  ///< number of corners used
  /// Increase of the sum of squares for the second of the two poses that a plane allows.
  double second_squares_px2 = 0.0;
  bool ambiguous = false;  ///< the second pose explains the corners nearly as well

  /// The board's plane: normal_camera . p_camera = distance_m, distance_m > 0.
  Eigen::Vector3d normal_camera() const;
  double distance_m() const;
};

/// The rotation by |turn| [rad] about `turn`.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn);

/// Estimates the pose of a board (z = 0, positions in metres) from its corners in an image [px].
///
/// `corner_sd_px` is the noise of a corner in one coordinate; it scales the covariance. None for
/// fewer than 6 corners, for vectors of different sizes, and when no pose in front of the camera
/// explains the corners.
std::optional<BoardPose> estimate_board_pose(const std::vector<Eigen::Vector2d>& corners_px,
                                             const std::vector<Eigen::Vector2d>& corners_m,
                                             const geometry::CameraModel& camera,
                                             double corner_sd_px);

/// Estimates the poses of a board in several images, with the corner noise taken from the residuals
/// of all images. None for images without a pose.
std::vector<std::optional<BoardPose>> estimate_board_poses(const std::vector<BoardView>& views,
                                                           const geometry::CameraModel& camera);

}  // namespace orchard::calibration
