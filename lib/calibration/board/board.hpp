// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image.hpp"

namespace orchard::calibration {

/// A grey image: rows top-down, no padding.
struct GreyPicture {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> grey;  ///< width_px x height_px
};

/// Decodes an image of any encoding to grey (Rec. 601, as OpenCV). None when the bytes are no image
/// of the stated size.
std::optional<GreyPicture> grey_of(const vision::Image& image);

/// Geometry of a flat chessboard for calibration.
///
/// Board frame: origin at the first inner corner, x along the columns, y along the rows, z into the
/// board's back. Seen upright from the front, x points right and y down, as in an image.
struct BoardConfig {
  int columns = 8;         ///< inner corners per row
  int rows = 6;            ///< inner corners per column
  double square_m = 0.03;  ///< side of a square
  double margin_m = 0.03;  ///< white margin beyond the outer squares
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

/// The inner corners of a board found in one image, row by row.
struct BoardView {
  std::vector<Eigen::Vector2d> corners_px;  ///< pixel centres have integer coordinates
  std::vector<Eigen::Vector2d> corners_m;   ///< the same corners in the board frame
};

/// Finds the board's inner corners in an image with subpixel accuracy. None when the board is not
/// fully in view. Deterministic.
///
/// A chessboard looks the same after a rotation by 180 degrees: its x axis is taken to point right
/// in the image, or down when the board is upright. Throws std::invalid_argument for a board that
/// problem_with() rejects.
std::optional<BoardView> find_board(const GreyPicture& picture, const BoardConfig& board);

/// The printed pattern of a board: black or white at every point of its sheet.
class BoardPattern {
 public:
  /// Throws std::invalid_argument for a board that problem_with() rejects.
  explicit BoardPattern(const BoardConfig& board);

  /// Whether a point (board frame [m]) is white; none outside the sheet.
  std::optional<bool> is_white(double x_m, double y_m) const;

 private:
  BoardConfig board_;
  BoardOutline outline_;
};

/// Indices of `count` places, in ascending order, each the farthest from those chosen before,
/// beginning with the first; all if there are no more.
std::vector<std::size_t> most_different(const std::vector<std::vector<double>>& places,
                                        std::size_t count);

}  // namespace orchard::calibration
