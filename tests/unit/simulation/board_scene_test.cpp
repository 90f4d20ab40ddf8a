// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/board_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "worlds/board_motion.hpp"

namespace orchard::simulation {
namespace {

using calibration::BoardConfig;

geometry::CameraIntrinsics tube_lens() {
  geometry::CameraIntrinsics camera;
  camera.fc_px = {221.5, 221.9};
  camera.cc_px = {161.3, 118.2};
  camera.kc = {-0.105, 0.018, 0.0006, -0.0004, 0.0};
  return camera;
}

/// Root mean square distance of found corners from where the lens puts them.
double corner_error_px(const BoardConfig& board, int num_views) {
  const geometry::CameraIntrinsics camera = tube_lens();
  const geometry::CameraModel model(camera);
  const BoardPainter painter(camera, board);
  Random random(5);
  double sum_px2 = 0.0;
  int count = 0;
  for (const Eigen::Isometry3d& T_camera_board : show_board(camera, board, num_views, {}, random)) {
    const auto view = calibration::find_board(painter.take(T_camera_board, random), board);
    if (!view) continue;
    for (std::size_t i = 0; i < view->corners_px.size(); ++i) {
      double nearest_px = 1e9;
      // a chessboard's frame may be turned by half a turn
      for (const bool turned : {false, true}) {
        double x_m = view->corners_m[i].x(), y_m = view->corners_m[i].y();
        if (turned) {
          x_m = (board.columns - 1) * board.square_m - x_m;
          y_m = (board.rows - 1) * board.square_m - y_m;
        }
        const auto truth_px = model.project(T_camera_board * Eigen::Vector3d(x_m, y_m, 0.0));
        nearest_px = std::min(nearest_px, std::hypot(view->corners_px[i].x() - truth_px->x(),
                                                     view->corners_px[i].y() - truth_px->y()));
      }
      sum_px2 += nearest_px * nearest_px;
      ++count;
    }
  }
  EXPECT_GT(count, num_views * board.columns * board.rows * 2 / 3);
  return std::sqrt(sum_px2 / count);
}

TEST(BoardPicture, CornersAreFoundWhereTheLensPutsThem) {
  EXPECT_LT(corner_error_px(BoardConfig{}, 12), 0.1);
}

TEST(BoardPicture, BeyondTheSheetThereIsNoBoard) {
  const BoardConfig board;
  const calibration::BoardPattern pattern(board);
  EXPECT_EQ(pattern.is_white(-0.045, -0.045), true);   // the margin
  EXPECT_EQ(pattern.is_white(-0.015, -0.015), false);  // the first square
  EXPECT_EQ(pattern.is_white(0.015, -0.015), true);
  EXPECT_FALSE(pattern.is_white(-0.061, 0.0));
  EXPECT_FALSE(pattern.is_white(0.0, 5 * 0.03 + 0.061));
}

TEST(BoardPicture, TheSameSeedGivesTheSameBytesAndNoBoardGivesNone) {
  const BoardConfig board;
  const BoardPainter painter(tube_lens(), board);
  Random one(3), two(3);
  const auto pose = show_board(tube_lens(), board, 1, {}, one);
  show_board(tube_lens(), board, 1, {}, two);
  ASSERT_EQ(pose.size(), 1u);
  EXPECT_EQ(painter.take(pose[0], one).grey, painter.take(pose[0], two).grey);
  EXPECT_FALSE(calibration::find_board(painter.take(std::nullopt, one), board));
  Eigen::Isometry3d from_behind = pose[0];
  from_behind.linear() *= Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_FALSE(calibration::find_board(painter.take(from_behind, one), board));
}

}  // namespace
}  // namespace orchard::simulation
