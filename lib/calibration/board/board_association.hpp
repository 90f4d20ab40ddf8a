// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/board/board.hpp"
#include "calibration/board/board_line.hpp"
#include "calibration/board/board_pose.hpp"

namespace orchard::calibration {

/// The board held still before both sensors: where the camera has it, and what of the scan may be
/// it.
struct MountView {
  BoardPose board;
  std::vector<BoardLine> lines;
  int num_scans = 1;  ///< that were averaged
};

/// A laser's place at a camera: p_camera = R_camera_laser p_laser + delta_m.
struct Mount {
  Eigen::Matrix3d R_camera_laser = Eigen::Matrix3d::Identity();
  Eigen::Vector3d delta_m = Eigen::Vector3d::Zero();
};

/// Which line is the board in each view, and a mount that makes it so.
struct Association {
  Mount mount;
  std::vector<int> line_of_view;  ///< index into MountView::lines; -1: none fits
  int num_fitting = 0;            ///< views with a line
  int rival_fitting = 0;          ///< the same of the best clearly different mount
};

/// Finds the one mount under which a line of each scan lies on that view's board, with no first
/// guess: all rotations are tried on a grid (12 degrees), the best are refined together with the
/// translation. What stands still (walls) or moves otherwise does not fit. Deterministic.
/// Source: n . R l = 0 and n . (R p + delta) = d for a line through p along l (Zhang and Pless,
/// IROS 2004; the linear part of Kassir and Peynot, ACRA 2010).
Association associate_board_lines(const std::vector<MountView>& views, const BoardOutline& outline);

}  // namespace orchard::calibration
