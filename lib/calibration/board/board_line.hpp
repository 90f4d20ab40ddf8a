// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

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

}  // namespace orchard::calibration
