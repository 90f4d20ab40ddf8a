// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/board/board.hpp"
#include "laser/scan.hpp"

namespace orchard::calibration {

/// Averages scans of a static scene beam by beam. Only ranges close to the median are averaged, so
/// that a beam on an edge does not end up between two surfaces. A beam without return in more than
/// half of the scans has no return. utime and seq are those of the middle scan. Throws
/// std::invalid_argument for no scan or scans of different shapes.
laser::Scan mean_scan(const std::vector<laser::Scan>& scans);

/// A scan and the board found in its image.
struct BoardPair {
  laser::Scan scan;
  BoardView board;
};

/// A stationary pose of the board: the mean of its pairs.
struct StationaryView {
  BoardView board;
  laser::Scan scan;
  int num_pairs = 1;
};

/// Finds stationary poses: neighbouring pairs (in order of time) between which no corner moved by
/// more than `shift_max_px` become one view, the mean of at most ten of them. Single pairs are left
/// out, because the board was moving and scan and image are not simultaneous.
std::vector<StationaryView> stationary_views(const std::vector<BoardPair>& pairs,
                                             double shift_max_px);

/// Makes each pair a separate view, for recordings with one pair per pose.
std::vector<StationaryView> single_views(const std::vector<BoardPair>& pairs);

/// Selects at most `count` views that differ most in position and size of the board in the image
/// (greedy), in their original order.
std::vector<StationaryView> spread_subset(const std::vector<StationaryView>& views, int count);

}  // namespace orchard::calibration
