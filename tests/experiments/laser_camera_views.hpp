// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/extrinsics/laser_camera_calibration.hpp"
#include "simulation/scene/board_scene.hpp"

namespace orchard::calibration_test {

/// What the calibration is given of a simulated board: found in pixels, lines found in scans.
struct SceneViews {
  std::vector<calibration::MountView> views;
  calibration::BoardOutline outline;
};

/// Where a board's inner corners truly are in the picture, with noise.
inline calibration::BoardView projected_corners(const Eigen::Isometry3d& T_camera_board,
                                                const calibration::BoardConfig& board,
                                                const geometry::CameraModel& camera,
                                                double noise_px, simulation::Random& random) {
  calibration::BoardView view;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const calibration::BoardPoint p{column * board.square_m, row * board.square_m};
      const auto pixel = camera.project(T_camera_board * Eigen::Vector3d(p.x_m, p.y_m, 0.0));
      if (!pixel) continue;
      view.corners_m.push_back(p);
      view.corners_px.push_back(
          {pixel->x() + random.normal(0.0, noise_px), pixel->y() + random.normal(0.0, noise_px)});
    }
  }
  return view;
}

/// One picture and the mean of `num_scans` scans of each pose. With corner_noise_px the corners
/// are the true ones with that noise instead of those found in a picture.
inline SceneViews views_of_scene(std::uint64_t seed, const simulation::RigConfig& rig,
                                 int num_scans, std::optional<double> corner_noise_px = {}) {
  const simulation::BoardScene scene(seed, rig);
  const geometry::CameraModel camera(rig.camera.intrinsics);
  simulation::Random random(seed, simulation::Stream::kBench);
  SceneViews out;
  out.outline = calibration::outline_of(scene.board());
  std::vector<calibration::BoardView> boards;
  std::vector<std::vector<laser::Scan>> scans;
  for (std::size_t i = 0; i < scene.poses().size(); ++i) {
    std::optional<calibration::BoardView> board;
    if (corner_noise_px) {
      board = projected_corners(scene.poses()[i], scene.board(), camera, *corner_noise_px, random);
    } else {
      board = calibration::find_board(scene.picture(scene.poses()[i], i), scene.board());
    }
    if (!board) continue;
    boards.push_back(*board);
    scans.emplace_back();
    for (int k = 0; k < num_scans; ++k) {
      scans.back().push_back(
          scene.scan(scene.poses()[i], 1000 * i + static_cast<std::uint64_t>(k)));
    }
  }
  const auto search = calibration::line_search(out.outline, rig.laser);
  const auto poses = calibration::estimate_board_poses(boards, camera);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i] || poses[i]->ambiguous) continue;
    calibration::MountView view;
    view.board = *poses[i];
    view.num_scans = num_scans;
    view.lines = calibration::find_board_lines(calibration::mean_scan(scans[i]), search);
    out.views.push_back(view);
  }
  return out;
}

}  // namespace orchard::calibration_test
