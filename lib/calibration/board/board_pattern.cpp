// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco/dictionary.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "calibration/board/marker_dictionary.hpp"

namespace orchard::calibration {

BoardPattern::BoardPattern(const BoardConfig& board) : board_(board), outline_(outline_of(board)) {
  if (const auto problem = problem_with(board)) throw std::invalid_argument(*problem);
  if (board.kind == BoardConfig::kChessboard) return;
  const auto dictionary = cv::aruco::getPredefinedDictionary(*marker_dictionary(board.dictionary));
  marker_cells_ = dictionary->markerSize + 2;
  for (int marker = 0; marker < board.columns * board.rows / 2; ++marker) {
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
        dictionary->bytesList.rowRange(marker, marker + 1), dictionary->markerSize);
    for (int row = 0; row < marker_cells_; ++row) {
      for (int column = 0; column < marker_cells_; ++column) {
        const bool border =
            row == 0 || column == 0 || row == marker_cells_ - 1 || column == marker_cells_ - 1;
        markers_.push_back(border ? 0 : bits.at<std::uint8_t>(row - 1, column - 1));
      }
    }
  }
}

bool BoardPattern::marker_is_white(int marker, double column_fraction, double row_fraction) const {
  const auto cell = [this](double fraction) {
    return std::clamp(static_cast<int>(fraction * marker_cells_), 0, marker_cells_ - 1);
  };
  const int index =
      (marker * marker_cells_ + cell(row_fraction)) * marker_cells_ + cell(column_fraction);
  return markers_[static_cast<std::size_t>(index)] != 0;
}

std::optional<bool> BoardPattern::is_white(double x_m, double y_m) const {
  if (!(x_m >= outline_.x_min_m && x_m <= outline_.x_max_m && y_m >= outline_.y_min_m &&
        y_m <= outline_.y_max_m)) {
    return std::nullopt;
  }
  // Squares are counted from the outermost one at the upper left, which is black.
  const double across = x_m / board_.square_m + 1.0, down = y_m / board_.square_m + 1.0;
  const int column = static_cast<int>(std::floor(across)), row = static_cast<int>(std::floor(down));
  if (column < 0 || row < 0 || column > board_.corner_columns() || row > board_.corner_rows()) {
    return true;
  }
  if ((column + row) % 2 == 0) return false;
  if (board_.kind == BoardConfig::kChessboard) return true;
  const double marker_fraction = board_.marker_m / board_.square_m;
  const double column_fraction = (across - column - 0.5) / marker_fraction + 0.5;
  const double row_fraction = (down - row - 0.5) / marker_fraction + 0.5;
  if (column_fraction < 0.0 || column_fraction >= 1.0 || row_fraction < 0.0 || row_fraction >= 1.0)
    return true;
  // Markers are numbered by the white squares, row by row.
  return marker_is_white((row * board_.columns + column) / 2, column_fraction, row_fraction);
}

}  // namespace orchard::calibration
