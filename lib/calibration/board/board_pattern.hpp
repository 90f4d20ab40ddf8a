// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/board/board.hpp"

namespace orchard::calibration {

/// The printed pattern of a board: black or white at every point of its sheet.
class BoardPattern {
 public:
  /// Throws std::invalid_argument for a board that problem_with() rejects.
  explicit BoardPattern(const BoardConfig& board);

  /// Whether a point (board frame [m]) is white; none outside the sheet.
  std::optional<bool> is_white(double x_m, double y_m) const;

 private:
  bool marker_is_white(int marker, double column_fraction, double row_fraction) const;

  BoardConfig board_;
  BoardOutline outline_;
  int marker_cells_ = 0;               ///< per side, black border included
  std::vector<std::uint8_t> markers_;  ///< 1 = white, cell by cell, marker by marker
};

}  // namespace orchard::calibration
