// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::cli {

/// Detections of the board in the given pictures.
struct BoardViews {
  std::vector<calibration::NamedView> views;
  std::vector<std::string> without_board;  ///< pictures without a detection
  std::string source;                      ///< for the user: "23 pictures", "drive.lcm"
  int width_px = 0;
  int height_px = 0;
};

/// Detects the board in picture files, in folders of them, or in the IMAGE messages of one log (at
/// most 400 of them, evenly spaced over the log). Throws io::FileError when a file cannot be read,
/// the pictures differ in size, there are none, or none shows the board.
BoardViews find_board_views(const std::vector<std::string>& paths,
                            const calibration::BoardConfig& board, bool quiet);

}  // namespace orchard::cli
