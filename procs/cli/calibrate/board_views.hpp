// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::cli {

/// The board in every picture that was given.
struct BoardViews {
  std::vector<calibration::NamedView> views;
  std::vector<std::string> without_board;  ///< names of the other pictures
  std::string source;                      ///< for people: "23 pictures", "drive.lcm"
  int width_px = 0;
  int height_px = 0;
};

/// Looks for the board in picture files and folders of them, or in the IMAGE messages of one log
/// (in 400 of them at most, evenly over the log). Throws io::FileError when a file cannot be read,
/// the pictures differ in size, there are none, or none shows the board.
BoardViews find_board_views(const std::vector<std::string>& paths,
                            const calibration::BoardConfig& board, bool quiet);

}  // namespace orchard::cli
