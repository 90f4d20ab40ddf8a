// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/aruco/dictionary.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "calibration/tuning.hpp"
#include "vision/decode.hpp"

namespace orchard::calibration {
namespace {

// physical: sizes of OpenCV's dictionaries.
constexpr std::array<int, 4> kCounts{50, 100, 250, 1000};

/// OpenCV's number of an ArUco dictionary by its name, such as "4x4_50"; none for an unknown name.
std::optional<int> marker_dictionary(const std::string& name) {
  // OpenCV numbers the dictionaries by bits, then by count.
  static_assert(cv::aruco::DICT_4X4_50 == 0 && cv::aruco::DICT_7X7_1000 == 15);
  for (int bits = 4; bits <= 7; ++bits) {
    for (std::size_t i = 0; i < kCounts.size(); ++i) {
      if (name == fmt::format("{}x{}_{}", bits, bits, kCounts[i])) {
        return 4 * (bits - 4) + static_cast<int>(i);
      }
    }
  }
  return std::nullopt;
}

/// Number of markers in the dictionary of this name; 0 for an unknown name.
int marker_count(const std::string& name) {
  const auto number = marker_dictionary(name);
  return number ? kCounts[static_cast<std::size_t>(*number % 4)] : 0;
}

}  // namespace

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

// derived: two more than the four that determine a homography.
/// Min number of corners of a ChArUco board; fewer do not determine its pose well.
constexpr std::size_t kMinCharucoCorners = 6;

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

/// Marks corners that are farther than a quarter of a square from their position under the
/// homography of most corners: outliers. Lens distortion is far smaller. `places` are in squares.
std::vector<bool> far_from_plane(const std::vector<cv::Point2f>& places,
                                 const std::vector<cv::Point2f>& corners) {
  std::vector<bool> far(corners.size(), true);
  const cv::Mat H_picture_board = cv::findHomography(places, corners, cv::LMEDS);
  if (H_picture_board.empty()) return far;
  const auto expected = [&](const cv::Point2f& place) {
    std::vector<cv::Point2f> pixel;
    cv::perspectiveTransform(std::vector<cv::Point2f>{place}, pixel, H_picture_board);
    return pixel[0];
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2f here = expected(places[i]);
    const double square_px = std::min(distance_px(here, expected(places[i] + cv::Point2f(1, 0))),
                                      distance_px(here, expected(places[i] + cv::Point2f(0, 1))));
    far[i] = !(distance_px(corners[i], here) <= 0.25 * square_px);
  }
  return far;
}

/// The image at twice its size, in which squares and markers of ten pixels can be found.
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

void add_corner(const cv::Point2f& corner, const cv::Point2f& place, const BoardConfig& board,
                BoardView& view) {
  view.corners_px.emplace_back(corner.x, corner.y);
  view.corners_m.emplace_back(place.x * board.square_m, place.y * board.square_m);
}

std::optional<BoardView> find_chessboard(const cv::Mat& grey, const BoardConfig& board) {
  std::vector<cv::Point2f> corners;
  if (!find_grid(grey, {board.columns, board.rows}, corners)) return std::nullopt;
  refine(grey, 0.4 * spacing_of(corners, board.columns, board.rows), corners);
  orient(corners, board.columns, board.rows);
  std::vector<cv::Point2f> places;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) places.emplace_back(column, row);
  }
  const std::vector<bool> far = far_from_plane(places, corners);
  if (std::find(far.begin(), far.end(), true) != far.end()) return std::nullopt;
  BoardView view;
  for (std::size_t i = 0; i < corners.size(); ++i) add_corner(corners[i], places[i], board, view);
  return view;
}

std::optional<BoardView> find_charuco(const cv::Mat& grey, const BoardConfig& board) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(*marker_dictionary(board.dictionary));
  const auto layout =
      cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                      static_cast<float>(board.marker_m), dictionary);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  const bool is_small = grey.cols <= tuning::kSmall_px;
  cv::aruco::detectMarkers(is_small ? doubled(grey) : grey, dictionary, markers, ids);
  if (is_small) {
    for (auto& marker : markers) halve(marker);
  }
  if (ids.empty()) return std::nullopt;
  std::vector<cv::Point2f> corners;
  std::vector<int> corner_ids;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, layout, corners, corner_ids);
  if (corners.size() < kMinCharucoCorners) return std::nullopt;
  double side_px = 1e9;
  for (const auto& marker : markers) {
    for (std::size_t i = 0; i < 4; ++i) {
      side_px = std::min(side_px, distance_px(marker[i], marker[(i + 1) % 4]));
    }
  }
  // OpenCV 4.6 gives these relative to the pixel's corner, everything else relative to its centre.
  for (cv::Point2f& corner : corners) corner -= cv::Point2f(0.5f, 0.5f);
  const std::vector<cv::Point2f> coarse = corners;
  // Windows up to the markers, whose edges would bias the corner.
  const double square_px = side_px * board.square_m / board.marker_m;
  refine(grey, 0.5 * (square_px - side_px), corners);
  const double most_moved_px = std::max(0.3, 0.02 * square_px);

  // OpenCV 4.6 numbers the inner corners row by row from the upper left.
  std::vector<cv::Point2f> places;
  for (const int id : corner_ids) {
    places.emplace_back(id % board.corner_columns(), id / board.corner_columns());
  }
  const std::vector<bool> far = far_from_plane(places, corners);
  BoardView view;
  bool one_row = true, one_column = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // A corner that moved far in the refinement was attracted by another edge.
    if (far[i] || distance_px(corners[i], coarse[i]) > most_moved_px) continue;
    add_corner(corners[i], places[i], board, view);
    one_row = one_row && view.corners_m.back().y() == view.corners_m[0].y();
    one_column = one_column && view.corners_m.back().x() == view.corners_m[0].x();
  }
  if (view.corners_px.size() < kMinCharucoCorners) return std::nullopt;
  if (one_row || one_column) return std::nullopt;
  return view;
}

}  // namespace

std::optional<std::string> problem_with(const BoardConfig& board) {
  if (board.columns < 3 || board.rows < 3 || board.columns > 50 || board.rows > 50) {
    return fmt::format(
        "a board of {} x {} cannot be detected: columns and rows must be 3 to 50 (inner corners of "
        "a chessboard, squares of a ChArUco board)",
        board.columns, board.rows);
  }
  if (!(board.square_m > 0.0) || !(board.square_m <= 5.0)) {
    return "the side of a square must be above 0 and at most 5 m; measure it on the board, in "
           "metres";
  }
  if (!(board.margin_m >= 0.0) || !(board.margin_m <= 5.0)) {
    return "the margin of the board must be 0 to 5 m; measure it on the board, in metres";
  }
  if (board.kind == BoardConfig::kChessboard) return std::nullopt;
  if (!(board.marker_m > 0.0) || !(board.marker_m < board.square_m)) {
    return "the side of a marker must be above 0 and below that of a square; measure both on the "
           "board";
  }
  const auto dictionary = marker_dictionary(board.dictionary);
  if (!dictionary) {
    return "unknown marker dictionary \"" + board.dictionary +
           "\"; give 4x4, 5x5, 6x6 or 7x7, followed by _50, _100, _250 or _1000 (such as 4x4_50)";
  }
  const int num_markers = board.columns * board.rows / 2;
  if (num_markers > marker_count(board.dictionary)) {
    return fmt::format(
        "the board has {} markers, but the dictionary {} has fewer; give the dictionary with which "
        "the board was printed",
        num_markers, board.dictionary);
  }
  return std::nullopt;
}

BoardOutline outline_of(const BoardConfig& board) {
  const double edge_m = board.square_m + board.margin_m;
  return {-edge_m, -edge_m, (board.corner_columns() - 1) * board.square_m + edge_m,
          (board.corner_rows() - 1) * board.square_m + edge_m};
}

std::optional<BoardView> find_board(const GreyPicture& picture, const BoardConfig& board) {
  if (const auto problem = problem_with(board)) throw std::invalid_argument(*problem);
  if (picture.width_px < 16 || picture.height_px < 16) return std::nullopt;
  const cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.grey.data()));
  return board.kind == BoardConfig::kChessboard ? find_chessboard(grey, board)
                                                : find_charuco(grey, board);
}

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
