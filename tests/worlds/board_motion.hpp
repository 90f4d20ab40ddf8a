// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {

/// Range of the poses in which a person holds a board before a camera.
struct BoardMotionConfig {
  double tilt_max_rad = 0.8;  ///< between the board's normal and the line of sight
  double turn_max_rad = 0.4;  ///< of the board in its own plane
  double size_min = 0.35;     ///< board width as a fraction of the picture width
  double size_max = 0.75;
  double reach = 1.0;  ///< 1: up to the picture's edges; 0: its middle only
};

/// Whether all corners of the board and half a square around them are in the picture.
inline bool is_in_view(const geometry::CameraModel& model, const calibration::BoardConfig& board,
                       const Eigen::Isometry3d& T_camera_board) {
  const double half_m = 0.5 * board.square_m;
  const double right_m = (board.columns - 1) * board.square_m + half_m;
  const double bottom_m = (board.rows - 1) * board.square_m + half_m;
  for (const double x_m : {-half_m, right_m}) {
    for (const double y_m : {-half_m, bottom_m}) {
      const auto pixel = model.project(T_camera_board * Eigen::Vector3d(x_m, y_m, 0.0));
      if (!pixel || !model.in_image(*pixel)) return false;
    }
  }
  return true;
}

/// Poses T_camera_board with every inner corner and half a square around it in the picture:
/// positions in all parts of the picture, tilts to all sides and several distances, as in a careful
/// calibration.
inline std::vector<Eigen::Isometry3d> show_board(const geometry::CameraIntrinsics& camera,
                                                 const calibration::BoardConfig& board,
                                                 int num_views, const BoardMotionConfig& config,
                                                 Random& random) {
  const geometry::CameraModel model(camera);
  const double width_m = (board.columns - 1) * board.square_m;
  const double height_m = (board.rows - 1) * board.square_m;
  const Eigen::Vector3d middle_board(0.5 * width_m, 0.5 * height_m, 0.0);
  constexpr int kTries = 400;  // per view, from the picture's edge towards its middle
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < num_views; ++i) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double reach = config.reach * (1.0 - static_cast<double>(attempt) / kTries);
      // Use the nine parts of the picture in turn.
      const double u = 0.5 + reach * ((i % 3 - 1) / 3.0 + random.uniform(-1.0 / 6.0, 1.0 / 6.0));
      const double v =
          0.5 + reach * ((i / 3 % 3 - 1) / 3.0 + random.uniform(-1.0 / 6.0, 1.0 / 6.0));
      const Eigen::Vector2d ray =
          model.undistort({u * (camera.width_px - 1), v * (camera.height_px - 1)});
      const double size = random.uniform(config.size_min, config.size_max);
      const double z_m = camera.fc_px[0] * width_m / (size * camera.width_px);
      // Tilt about axes in all directions, mostly by large angles.
      const double axis_rad = geometry::kPi * (2.0 * i / 5.0 + random.uniform(-0.3, 0.3));
      const double tilt_rad = config.tilt_max_rad * std::sqrt(random.uniform());
      const double turn_rad = random.uniform(-config.turn_max_rad, config.turn_max_rad);
      Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
      T_camera_board.linear() =
          (Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(std::cos(axis_rad), std::sin(axis_rad), 0)) *
           Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()))
              .toRotationMatrix();
      T_camera_board.translation() = Eigen::Vector3d(ray.x() * z_m, ray.y() * z_m, z_m) -
                                     T_camera_board.linear() * middle_board;
      if (!is_in_view(model, board, T_camera_board)) continue;
      poses.push_back(T_camera_board);
      break;
    }
  }
  return poses;
}

}  // namespace orchard::simulation
