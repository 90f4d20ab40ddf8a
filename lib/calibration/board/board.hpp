// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/board/grey_picture.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// Geometry and pattern of a flat calibration board.
///
/// Board frame: origin at the first inner corner, x along the columns, y along the rows, z into the
/// board's back. Seen upright from the front, x points right and y down, as in an image.
struct BoardConfig {
  enum Kind { kChessboard, kCharuco };
  Kind kind = kChessboard;
  int columns = 8;                    ///< inner corners (chessboard) or squares (ChArUco) per row
  int rows = 6;                       ///< inner corners or squares per column
  double square_m = 0.03;             ///< side of a square
  double marker_m = 0.022;            ///< side of a marker, black border included (ChArUco)
  std::string dictionary = "4x4_50";  ///< of the markers: 4x4|5x5|6x6|7x7 _ 50|100|250|1000
  double margin_m = 0.03;             ///< white margin beyond the outer squares

  int corner_columns() const { return kind == kChessboard ? columns : columns - 1; }
  int corner_rows() const { return kind == kChessboard ? rows : rows - 1; }
};

/// The error in a board's description, as one clause with the remedy; none when it is valid.
std::optional<std::string> problem_with(const BoardConfig& board);

/// The outline of the sheet, margin included, in the board frame [m].
struct BoardOutline {
  double x_min_m = 0.0;
  double y_min_m = 0.0;
  double x_max_m = 0.0;
  double y_max_m = 0.0;
};
BoardOutline outline_of(const BoardConfig& board);

/// A point in an image; pixel centres have integer coordinates.
struct ImagePoint {
  double x_px = 0.0;
  double y_px = 0.0;
};

/// A point on the board, in the board frame.
struct BoardPoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// The inner corners of a board found in one image: all corners of a chessboard, row by row, or the
/// visible corners of a ChArUco board.
struct BoardView {
  std::vector<ImagePoint> corners_px;
  std::vector<BoardPoint> corners_m;  ///< the same corners in the board frame, in the same order
};

/// Finds the board's inner corners in an image with subpixel accuracy. None when the board is not
/// in view; a chessboard must be fully in view. Deterministic.
///
/// A chessboard looks the same after a rotation by 180 degrees: its x axis is taken to point right
/// in the image, or down when the board is upright. Throws std::invalid_argument for a board that
/// problem_with() rejects.
std::optional<BoardView> find_board(const GreyPicture& picture, const BoardConfig& board);
std::optional<BoardView> find_board(const vision::PixelBlock& pixels, const BoardConfig& board);

}  // namespace orchard::calibration
