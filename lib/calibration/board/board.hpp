// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/board/grey_picture.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// A flat calibration board, as it was printed.
///
/// Board frame: origin at the first inner corner, x along the columns, y along the rows, z into the
/// board's back: seen upright from the front, x points right and y down, as in a picture.
struct BoardConfig {
  enum Kind { kChessboard, kCharuco };
  Kind kind = kChessboard;
  int columns = 8;                    ///< inner corners (chessboard) or squares (ChArUco) per row
  int rows = 6;                       ///< and per column
  double square_m = 0.03;             ///< side of a square
  double marker_m = 0.022;            ///< side of a marker, black border included (ChArUco)
  std::string dictionary = "4x4_50";  ///< of the markers: 4x4|5x5|6x6|7x7 _ 50|100|250|1000
  double margin_m = 0.03;             ///< of white paper or board beyond the outer squares

  int corner_columns() const { return kind == kChessboard ? columns : columns - 1; }
  int corner_rows() const { return kind == kChessboard ? rows : rows - 1; }
};

/// What is wrong with a board's description, in one clause with what to do; none when it can be
/// looked for.
std::optional<std::string> problem_with(const BoardConfig& board);

/// The outline of the sheet, margin included, in the board frame [m].
struct BoardOutline {
  double x_min_m = 0.0;
  double y_min_m = 0.0;
  double x_max_m = 0.0;
  double y_max_m = 0.0;
};
BoardOutline outline_of(const BoardConfig& board);

/// A place in a picture; pixel centres are whole numbers.
struct ImagePoint {
  double x_px = 0.0;
  double y_px = 0.0;
};

/// A place on the board, in the board frame.
struct BoardPoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// The inner corners of a board in one picture: those of a chessboard are all there, row by row;
/// of a ChArUco board those that were seen.
struct BoardView {
  std::vector<ImagePoint> corners_px;
  std::vector<BoardPoint> corners_m;  ///< as many, in the same order
};

/// The board's inner corners in a picture, to a fraction of a pixel; none when it is not (wholly,
/// for a chessboard) in view. The same picture gives the same numbers.
///
/// A chessboard looks the same after half a turn: its x axis is taken to point to the picture's
/// right, or down when it stands upright. Throws std::invalid_argument for a board that
/// problem_with() refuses.
std::optional<BoardView> find_board(const GreyPicture& picture, const BoardConfig& board);
std::optional<BoardView> find_board(const vision::PixelBlock& pixels, const BoardConfig& board);

}  // namespace orchard::calibration
