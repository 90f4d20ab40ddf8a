// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {

/// How a person holds a board before a camera.
struct BoardMotionConfig {
  bool whole_board = true;    ///< in the picture; otherwise its middle, as suffices for ChArUco
  double tilt_max_rad = 0.8;  ///< between the board's normal and the line of sight
  double turn_max_rad = 0.4;  ///< of the board in its own plane
  double size_min = 0.35;     ///< of the board's width in the picture's
  double size_max = 0.75;
  double reach = 1.0;  ///< 1: up to the picture's edges; 0: its middle only
};

/// Poses T_camera_board, with every inner corner and half a square around it in the picture: places
/// all over it, tilts to all sides and several distances, as a careful person would show it.
std::vector<Eigen::Isometry3d> show_board(const geometry::CameraIntrinsics& camera,
                                          const calibration::BoardConfig& board, int num_views,
                                          const BoardMotionConfig& config, Random& random);

}  // namespace orchard::simulation
