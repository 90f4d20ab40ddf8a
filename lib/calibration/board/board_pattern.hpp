// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/board/board.hpp"

namespace orchard::calibration {

/// What is printed on a board: black or white at every place of its sheet.
class BoardPattern {
 public:
  /// Throws std::invalid_argument for a board that problem_with() refuses.
  explicit BoardPattern(const BoardConfig& board);

  /// Whether a place (board frame, metres) is white; none beyond the sheet.
  std::optional<bool> is_white(double x_m, double y_m) const;

 private:
  bool marker_is_white(int marker, double column_fraction, double row_fraction) const;

  BoardConfig board_;
  BoardOutline outline_;
  int marker_cells_ = 0;               ///< per side, black border included
  std::vector<std::uint8_t> markers_;  ///< 1 = white, cell by cell, marker by marker
};

}  // namespace orchard::calibration
