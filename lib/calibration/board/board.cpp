// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "calibration/tuning.hpp"
#include "vision/decode.hpp"

namespace orchard::calibration {
std::optional<GreyPicture> grey_of(const vision::Image& image) {
  if (image.width_px <= 0 || image.height_px <= 0) return std::nullopt;
  if (image.encoding == vision::Encoding::kGray8) {
    if (image.data.size() !=
        static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px)) {
      return std::nullopt;
    }
    return GreyPicture{image.width_px, image.height_px, image.data};
  }
  const auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) return std::nullopt;
  const cv::Mat bgr(image.height_px, image.width_px, CV_8UC3,
                    const_cast<std::uint8_t*>(pixels->bgr.data()));
  GreyPicture picture{image.width_px, image.height_px, {}};
  picture.grey.resize(bgr.total());
  cv::Mat grey(bgr.size(), CV_8UC1, picture.grey.data());
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return picture;
}

namespace {

double distance_px(const cv::Point2f& a, const cv::Point2f& b) {
  return std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y);
}

/// Refines corners to subpixel accuracy in windows of half width `reach_px`; the larger the window,
/// the lower the noise.
void refine(const cv::Mat& grey, double reach_px, std::vector<cv::Point2f>& corners) {
  const int half_px = std::clamp(static_cast<int>(std::lround(reach_px)), 2, 11);
  cv::cornerSubPix(grey, corners, {half_px, half_px}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-4});
}

/// The smallest distance between neighbours in a complete grid.
double spacing_of(const std::vector<cv::Point2f>& grid, int columns, int rows) {
  double least_px = 1e9;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Point2f& here = grid[static_cast<std::size_t>(row * columns + column)];
      if (column + 1 < columns) {
        least_px =
            std::min(least_px,
                     distance_px(here, grid[static_cast<std::size_t>(row * columns + column + 1)]));
      }
      if (row + 1 < rows) {
        least_px = std::min(
            least_px,
            distance_px(here, grid[static_cast<std::size_t>((row + 1) * columns + column)]));
      }
    }
  }
  return least_px;
}

/// Orders a grid such that z points into the board's back and x right (or down) in the image.
void orient(std::vector<cv::Point2f>& grid, int columns, int rows) {
  const auto at = [&](int column, int row) {
    return grid[static_cast<std::size_t>(row * columns + column)];
  };
  const cv::Point2f x = at(columns - 1, 0) - at(0, 0), y = at(0, rows - 1) - at(0, 0);
  if (x.x * y.y - x.y * y.x < 0.0f) {
    for (int row = 0; row < rows; ++row) {
      std::reverse(grid.begin() + row * columns, grid.begin() + (row + 1) * columns);
    }
  }
  const cv::Point2f along = at(columns - 1, 0) - at(0, 0);
  const bool lies = std::abs(along.x) >= std::abs(along.y);
  if ((lies ? along.x : along.y) < 0.0f) std::reverse(grid.begin(), grid.end());
}

/// Whether a corner is farther than a quarter of a square from its position under the homography of
/// most corners. Lens distortion is far smaller. `places` are in squares.
bool has_outlier(const std::vector<cv::Point2f>& places, const std::vector<cv::Point2f>& corners) {
  const cv::Mat H_picture_board = cv::findHomography(places, corners, cv::LMEDS);
  if (H_picture_board.empty()) return true;
  const auto expected = [&](const cv::Point2f& place) {
    std::vector<cv::Point2f> pixel;
    cv::perspectiveTransform(std::vector<cv::Point2f>{place}, pixel, H_picture_board);
    return pixel[0];
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2f here = expected(places[i]);
    const double square_px = std::min(distance_px(here, expected(places[i] + cv::Point2f(1, 0))),
                                      distance_px(here, expected(places[i] + cv::Point2f(0, 1))));
    if (!(distance_px(corners[i], here) <= 0.25 * square_px)) return true;
  }
  return false;
}

/// The image at twice its size, in which squares of ten pixels can be found.
cv::Mat doubled(const cv::Mat& grey) {
  cv::Mat twice;
  cv::resize(grey, twice, {}, 2.0, 2.0, cv::INTER_LINEAR);
  return twice;
}

void halve(std::vector<cv::Point2f>& corners) {
  const cv::Point2f half(0.5f, 0.5f);  // pixel centres have integer coordinates in both images
  for (cv::Point2f& corner : corners) corner = 0.5f * (corner + half) - half;
}

/// Finds a complete grid, not yet refined.
bool find_grid(const cv::Mat& grey, cv::Size size, std::vector<cv::Point2f>& corners) {
  if (cv::findChessboardCornersSB(grey, size, corners)) return true;
  if (grey.cols > tuning::kSmall_px || !cv::findChessboardCornersSB(doubled(grey), size, corners)) {
    return false;
  }
  halve(corners);
  return true;
}

}  // namespace

std::optional<std::string> problem_with(const BoardConfig& board) {
  if (board.columns < 3 || board.rows < 3 || board.columns > 50 || board.rows > 50) {
    return fmt::format(
        "a board of {} x {} cannot be detected: columns and rows must be 3 to 50 inner corners",
        board.columns, board.rows);
  }
  if (!(board.square_m > 0.0) || !(board.square_m <= 5.0)) {
    return "the side of a square must be above 0 and at most 5 m; measure it on the board, in "
           "metres";
  }
  if (!(board.margin_m >= 0.0) || !(board.margin_m <= 5.0)) {
    return "the margin of the board must be 0 to 5 m; measure it on the board, in metres";
  }
  return std::nullopt;
}

BoardOutline outline_of(const BoardConfig& board) {
  const double edge_m = board.square_m + board.margin_m;
  return {-edge_m, -edge_m, (board.columns - 1) * board.square_m + edge_m,
          (board.rows - 1) * board.square_m + edge_m};
}

std::optional<BoardView> find_board(const GreyPicture& picture, const BoardConfig& board) {
  if (const auto problem = problem_with(board)) throw std::invalid_argument(*problem);
  if (picture.width_px < 16 || picture.height_px < 16) return std::nullopt;
  const cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.grey.data()));
  std::vector<cv::Point2f> corners;
  if (!find_grid(grey, {board.columns, board.rows}, corners)) return std::nullopt;
  refine(grey, 0.4 * spacing_of(corners, board.columns, board.rows), corners);
  orient(corners, board.columns, board.rows);
  std::vector<cv::Point2f> places;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) places.emplace_back(column, row);
  }
  if (has_outlier(places, corners)) return std::nullopt;
  BoardView view;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    view.corners_px.emplace_back(corners[i].x, corners[i].y);
    view.corners_m.emplace_back(places[i].x * board.square_m, places[i].y * board.square_m);
  }
  return view;
}

BoardPattern::BoardPattern(const BoardConfig& board) : board_(board), outline_(outline_of(board)) {
  if (const auto problem = problem_with(board)) throw std::invalid_argument(*problem);
}

std::optional<bool> BoardPattern::is_white(double x_m, double y_m) const {
  if (!(x_m >= outline_.x_min_m && x_m <= outline_.x_max_m && y_m >= outline_.y_min_m &&
        y_m <= outline_.y_max_m)) {
    return std::nullopt;
  }
  // Squares are counted from the outermost one at the upper left, which is black.
  const double across = x_m / board_.square_m + 1.0, down = y_m / board_.square_m + 1.0;
  const int column = static_cast<int>(std::floor(across)), row = static_cast<int>(std::floor(down));
  if (column < 0 || row < 0 || column > board_.columns || row > board_.rows) return true;
  return (column + row) % 2 != 0;
}

std::vector<std::size_t> most_different(const std::vector<std::vector<double>>& places,
                                        std::size_t count) {
  std::vector<std::size_t> chosen(places.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  if (places.size() <= count) return chosen;
  chosen.clear();
  std::vector<double> nearest2(places.size(), std::numeric_limits<double>::max());
  for (std::size_t next = 0; chosen.size() < count;) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < places.size(); ++i) {
      double distance2 = 0.0;
      for (std::size_t k = 0; k < places[i].size(); ++k) {
        distance2 += (places[i][k] - places[next][k]) * (places[i][k] - places[next][k]);
      }
      nearest2[i] = std::min(nearest2[i], distance2);
    }
    next = static_cast<std::size_t>(std::max_element(nearest2.begin(), nearest2.end()) -
                                    nearest2.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace orchard::calibration
