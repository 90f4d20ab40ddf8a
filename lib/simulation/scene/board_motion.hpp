// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {

/// Range of the poses in which a person holds a board before a camera.
struct BoardMotionConfig {
  bool whole_board = true;    ///< whole board in the picture; else its middle (enough for ChArUco)
  double tilt_max_rad = 0.8;  ///< between the board's normal and the line of sight
  double turn_max_rad = 0.4;  ///< of the board in its own plane
  double size_min = 0.35;     ///< board width as a fraction of the picture width
  double size_max = 0.75;
  double reach = 1.0;  ///< 1: up to the picture's edges; 0: its middle only
};

/// Poses T_camera_board with every inner corner and half a square around it in the picture:
/// positions in all parts of the picture, tilts to all sides and several distances, as in a careful
/// calibration.
std::vector<Eigen::Isometry3d> show_board(const geometry::CameraIntrinsics& camera,
                                          const calibration::BoardConfig& board, int num_views,
                                          const BoardMotionConfig& config, Random& random);

}  // namespace orchard::simulation
