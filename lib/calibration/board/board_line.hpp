// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "laser/scan.hpp"

namespace orchard::calibration {

/// What the trace of a board in a scan may look like.
struct BoardLineSearch {
  double length_min_m = 0.2;  ///< shorter ones fix no direction
  double length_max_m = 1.0;  ///< the board's diagonal
  double range_max_m = 6.0;   ///< a board farther away is not looked for
  int min_beams = 8;
  double range_sd_m = 0.003;  ///< noise of a range, constant part; only its upper bound matters
  double range_sd_fraction = 0.006;  ///< and per metre
};

/// One end of a line.
struct LineEnd {
  bool seen = false;          ///< beyond it the scanner saw farther: the thing itself ends here
  double bearing_rad = 0.0;   ///< laser frame, of the edge
  double half_gap_rad = 0.0;  ///< the edge lies within this of bearing_rad
};

/// A straight stretch of a scan that may be a board, in the laser frame (x forward, y left).
struct BoardLine {
  std::vector<double> ranges_m;  ///< of the beams on it, in order of bearing
  std::vector<double> bearings_rad;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();  ///< halfway between its ends
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double length_m = 0.0;
  double rms_m = 0.0;  ///< of the points about the line
  LineEnd start;       ///< at the first beam
  LineEnd end;         ///< at the last
};

/// All stretches of a scan that could be a board, by split and merge with a robust total least
/// squares fit, in order of bearing. Bent, short and long things are left out; which of the rest
/// is the board, a single scan cannot tell.
std::vector<BoardLine> find_board_lines(const laser::Scan& scan, const BoardLineSearch& search);

}  // namespace orchard::calibration
