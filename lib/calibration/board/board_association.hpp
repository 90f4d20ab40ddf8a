// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/board/board.hpp"
#include "calibration/board/board_line.hpp"
#include "calibration/board/board_pose.hpp"

namespace orchard::calibration {

/// One stationary view of the board: its pose in the camera frame, and candidate lines in the scan.
struct ExtrinsicsView {
  BoardPose board;
  std::vector<BoardLine> lines;
  int num_scans = 1;  ///< number of averaged scans
};

/// Laser-camera extrinsics: p_camera = R_camera_laser p_laser + delta_m.
struct RigidExtrinsics {
  Eigen::Matrix3d R_camera_laser = Eigen::Matrix3d::Identity();
  Eigen::Vector3d delta_m = Eigen::Vector3d::Zero();
};

/// The line of the board in each view, and the extrinsics under which they fit.
struct Association {
  RigidExtrinsics mount;
  std::vector<int> line_of_view;  ///< index into ExtrinsicsView::lines; -1: no line fits
  int num_fitting = 0;            ///< number of views with a line that fits
  int rival_fitting = 0;          ///< the same number for the best clearly different extrinsics
};

/// Finds the extrinsics for which one line of each scan lies on the board of that view, without an
/// initial guess: rotations are tried on a grid of 12 degrees, and the best are refined together
/// with the translation. Lines on static objects (walls) do not fit all views. Deterministic.
/// Source: n . R l = 0 and n . (R p + delta) = d for a line through p along l (Zhang and Pless,
/// IROS 2004; the linear part of Kassir and Peynot, ACRA 2010).
Association associate_board_lines(const std::vector<ExtrinsicsView>& views,
                                  const BoardOutline& outline);

}  // namespace orchard::calibration
