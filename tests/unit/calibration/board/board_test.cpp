// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace orchard::calibration {
namespace {

constexpr int kSquare_px = 40, kMargin_px = 60;

GreyPicture picture_of(const cv::Mat& grey) {
  GreyPicture picture{grey.cols, grey.rows, {}};
  picture.grey.resize(grey.total());
  for (int v = 0; v < grey.rows; ++v) {
    std::memcpy(&picture.grey[static_cast<std::size_t>(v) * grey.cols], grey.ptr(v), grey.cols);
  }
  return picture;
}

/// Squares of whole pixels: the inner corner (0, 0) lies between pixels 99 and 100.
cv::Mat chessboard(int columns, int rows) {
  cv::Mat grey((rows + 1) * kSquare_px + 2 * kMargin_px,
               (columns + 1) * kSquare_px + 2 * kMargin_px, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      if ((row + column) % 2 == 0) {
        grey({kMargin_px + column * kSquare_px, kMargin_px + row * kSquare_px, kSquare_px,
              kSquare_px}) = cv::Scalar(0);
      }
    }
  }
  return grey;
}

void expect_straight_grid(const BoardView& view, const BoardConfig& board) {
  ASSERT_EQ(view.corners_px.size(), view.corners_m.size());
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const double first_px = kMargin_px + kSquare_px - 0.5;
    EXPECT_NEAR(view.corners_px[i].x_px,
                first_px + view.corners_m[i].x_m / board.square_m * kSquare_px, 0.02);
    EXPECT_NEAR(view.corners_px[i].y_px,
                first_px + view.corners_m[i].y_m / board.square_m * kSquare_px, 0.02);
  }
}

TEST(Board, FindsEveryCornerOfAChessboardWhereItIs) {
  BoardConfig board;
  for (const auto& [columns, rows] : {std::pair{8, 6}, {7, 6}, {6, 8}, {5, 7}, {6, 6}}) {
    board.columns = columns;
    board.rows = rows;
    const auto view = find_board(picture_of(chessboard(columns, rows)), board);
    ASSERT_TRUE(view) << columns << " x " << rows;
    EXPECT_EQ(view->corners_px.size(), static_cast<std::size_t>(columns * rows));
    expect_straight_grid(*view, board);
  }
}

TEST(Board, AChessboardsFrameStaysRightHandedHoweverItIsTurned) {
  BoardConfig board;
  const cv::Mat straight = chessboard(8, 6);
  for (const int turn : {cv::ROTATE_180, cv::ROTATE_90_CLOCKWISE, cv::ROTATE_90_COUNTERCLOCKWISE}) {
    cv::Mat turned;
    cv::rotate(straight, turned, turn);
    const auto view = find_board(picture_of(turned), board);
    ASSERT_TRUE(view) << turn;
    const ImagePoint first = view->corners_px[0], along = view->corners_px[7],
                     down = view->corners_px[40];
    const double x_x = along.x_px - first.x_px, x_y = along.y_px - first.y_px;
    const double y_x = down.x_px - first.x_px, y_y = down.y_px - first.y_px;
    EXPECT_GT(x_x * y_y - x_y * y_x, 0.0) << "z must point into the board's back";
    EXPECT_GT(x_x + x_y, 0.0) << "x must point right or down";
  }
}

TEST(Board, NumbersTheCornersOfACharucoBoardFromItsUpperLeft) {
  BoardConfig board;
  board.kind = BoardConfig::kCharuco;
  board.columns = 7;
  board.rows = 5;
  board.square_m = 0.04;
  board.marker_m = 0.03;
  const auto layout = cv::aruco::CharucoBoard::create(
      7, 5, 0.04f, 0.03f, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
  cv::Mat grey;
  layout->draw({7 * kSquare_px + 2 * kMargin_px, 5 * kSquare_px + 2 * kMargin_px}, grey,
               kMargin_px);
  const auto view = find_board(picture_of(grey), board);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->corners_px.size(), 24u);
  expect_straight_grid(*view, board);

  // half of it hidden: the rest keeps its places
  grey.colRange(0, grey.cols / 2) = cv::Scalar(255);
  const auto half = find_board(picture_of(grey), board);
  ASSERT_TRUE(half);
  EXPECT_LT(half->corners_px.size(), 24u);
  expect_straight_grid(*half, board);
}

TEST(Board, GivesNothingWhenThereIsNone) {
  BoardConfig chess, charuco;
  charuco.kind = BoardConfig::kCharuco;
  cv::Mat empty(240, 320, CV_8UC1, cv::Scalar(128));
  for (const BoardConfig& board : {chess, charuco}) {
    EXPECT_FALSE(find_board(picture_of(empty), board));
    EXPECT_FALSE(find_board(GreyPicture{}, board));
  }
  EXPECT_FALSE(find_board(picture_of(chessboard(5, 4)), chess)) << "another board";
  cv::Mat cut = chessboard(8, 6);
  EXPECT_FALSE(find_board(picture_of(cut.colRange(0, cut.cols - 150)), chess)) << "cut off";
}

TEST(Board, RefusesBoardsThatCannotBe) {
  BoardConfig board;
  EXPECT_FALSE(problem_with(board));
  for (const auto change : std::vector<void (*)(BoardConfig&)>{
           [](BoardConfig& b) { b.columns = 2; }, [](BoardConfig& b) { b.rows = 4000; },
           [](BoardConfig& b) { b.square_m = 0.0; }, [](BoardConfig& b) { b.square_m = 30.0; },
           [](BoardConfig& b) { b.margin_m = -1.0; },
           [](BoardConfig& b) {
             b.kind = BoardConfig::kCharuco;
             b.marker_m = b.square_m;
           },
           [](BoardConfig& b) {
             b.kind = BoardConfig::kCharuco;
             b.dictionary = "3x3_50";
           },
           [](BoardConfig& b) {
             b.kind = BoardConfig::kCharuco;
             b.columns = b.rows = 12;
           }}) {
    BoardConfig changed = board;
    change(changed);
    EXPECT_TRUE(problem_with(changed));
    EXPECT_THROW(find_board(GreyPicture{64, 64, std::vector<std::uint8_t>(64 * 64)}, changed),
                 std::invalid_argument);
  }
}

TEST(Board, ItsOutlineIncludesOuterSquaresAndMargin) {
  BoardConfig board;
  board.margin_m = 0.01;
  const BoardOutline outline = outline_of(board);
  EXPECT_DOUBLE_EQ(outline.x_min_m, -0.04);
  EXPECT_DOUBLE_EQ(outline.x_max_m, 7 * 0.03 + 0.04);
  EXPECT_DOUBLE_EQ(outline.y_max_m, 5 * 0.03 + 0.04);
}

}  // namespace
}  // namespace orchard::calibration
