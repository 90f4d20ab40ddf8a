// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/board/board.hpp"
#include "laser/scan.hpp"

namespace orchard::calibration {

/// A scan and the board in its picture.
struct BoardPair {
  laser::Scan scan;
  BoardView board;
};

/// What was held still: the mean of its pairs.
struct StillView {
  BoardView board;
  laser::Scan scan;
  int num_pairs = 1;
};

/// Neighbouring pairs (in order of time) between which no corner moved by more than `shift_max_px`
/// become one view: the mean of at most ten of them. A board seen in only one pair in a row was
/// moving, and what moves between a scan and its picture is of no use: it is left out.
std::vector<StillView> still_views(const std::vector<BoardPair>& pairs, double shift_max_px);

/// Every pair as a view of its own: for recordings that have one pair per pose.
std::vector<StillView> single_views(const std::vector<BoardPair>& pairs);

/// At most `count` of the views, as different from each other as they can be found greedily
/// (place and size of the board in the picture), in their order.
std::vector<StillView> spread_subset(const std::vector<StillView>& views, int count);

}  // namespace orchard::calibration
