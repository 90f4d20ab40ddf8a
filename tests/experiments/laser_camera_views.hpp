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
  std::vector<calibration::ExtrinsicsView> views;
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
/// are the true ones with that noise instead of those found in a picture. The square's size is
/// given as `stated_of_true` times what it is; the outline, which a person measures by itself, as
/// it is.
inline SceneViews views_of_scene(std::uint64_t seed, const simulation::RigConfig& rig,
                                 int num_scans, std::optional<double> corner_noise_px = {},
                                 double stated_of_true = 1.0, bool outline_measured = true) {
  const simulation::BoardScene scene(seed, rig);
  const geometry::CameraModel camera(rig.camera.intrinsics);
  simulation::Random random(seed, simulation::Stream::kBench);
  SceneViews out;
  calibration::BoardConfig stated = scene.board();
  stated.square_m *= stated_of_true;
  stated.marker_m *= stated_of_true;
  out.outline = calibration::outline_of(stated);
  if (outline_measured) {
    const auto sheet = calibration::outline_of(scene.board());
    const double x_m = 0.5 * (out.outline.x_min_m + out.outline.x_max_m);
    const double y_m = 0.5 * (out.outline.y_min_m + out.outline.y_max_m);
    const double half_x_m = 0.5 * (sheet.x_max_m - sheet.x_min_m);
    const double half_y_m = 0.5 * (sheet.y_max_m - sheet.y_min_m);
    out.outline = {x_m - half_x_m, y_m - half_y_m, x_m + half_x_m, y_m + half_y_m};
  }
  std::vector<calibration::BoardView> boards;
  std::vector<std::vector<laser::Scan>> scans;
  for (std::size_t i = 0; i < scene.poses().size(); ++i) {
    std::optional<calibration::BoardView> board;
    if (corner_noise_px) {
      board = projected_corners(scene.poses()[i], scene.board(), camera, *corner_noise_px, random);
      if (board) {
        for (auto& p : board->corners_m) p = {p.x_m * stated_of_true, p.y_m * stated_of_true};
      }
    } else {
      board = calibration::find_board(scene.picture(scene.poses()[i], i), stated);
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
    calibration::ExtrinsicsView view;
    view.board = *poses[i];
    view.num_scans = num_scans;
    view.lines = calibration::find_board_lines(calibration::mean_scan(scans[i]), search);
    out.views.push_back(view);
  }
  return out;
}

}  // namespace orchard::calibration_test
