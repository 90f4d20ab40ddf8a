// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/board/board.hpp"
#include "calibration/board/board_pose.hpp"
#include "laser/scan.hpp"

namespace orchard::calibration {

/// Limits for lines in a scan that may be the board.
struct BoardLineSearch {
  double length_min_m = 0.2;  ///< shorter lines do not determine a direction
  double length_max_m = 1.0;  ///< the board's diagonal
  double range_max_m = 6.0;   ///< max range of the board
  int min_beams = 8;
  double range_sd_m = 0.003;         ///< range noise, constant part; an upper bound is sufficient
  double range_sd_fraction = 0.006;  ///< range noise per metre of range
};

/// One end of a line.
struct LineEnd {
  bool seen = false;          ///< the next ranges are larger, so this is the object's own edge
  double bearing_rad = 0.0;   ///< of the edge, laser frame
  double half_gap_rad = 0.0;  ///< the edge lies within this of bearing_rad
};

/// A straight segment of a scan that may be the board, in the laser frame (x forward, y left).
struct BoardLine {
  std::vector<double> ranges_m;  ///< of its beams, in order of bearing
  std::vector<double> bearings_rad;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();  ///< halfway between its ends
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double length_m = 0.0;
  double rms_m = 0.0;  ///< RMS distance of the points from the line
  LineEnd start;       ///< at the first beam
  LineEnd end;         ///< at the last
};

/// Finds all straight segments of a scan that may be the board, in order of bearing: split and
/// merge with a robust total least squares fit. Curved, short and long segments are left out. A
/// single scan cannot tell which of the others is the board; see associate_board_lines().
std::vector<BoardLine> find_board_lines(const laser::Scan& scan, const BoardLineSearch& search);

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
