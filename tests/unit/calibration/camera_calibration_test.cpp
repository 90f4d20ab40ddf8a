// SPDX-License-Identifier: BSD-3-Clause
// Corners from the projection equations with Gaussian noise: the truth is known exactly.
#include "calibration/board/board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/board/camera_calibration.hpp"
#include "worlds/board_motion.hpp"

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
    EXPECT_NEAR(view.corners_px[i].x(),
                first_px + view.corners_m[i].x() / board.square_m * kSquare_px, 0.02);
    EXPECT_NEAR(view.corners_px[i].y(),
                first_px + view.corners_m[i].y() / board.square_m * kSquare_px, 0.02);
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
    const Eigen::Vector2d first = view->corners_px[0], along = view->corners_px[7],
                          down = view->corners_px[40];
    const double x_x = along.x() - first.x(), x_y = along.y() - first.y();
    const double y_x = down.x() - first.x(), y_y = down.y() - first.y();
    EXPECT_GT(x_x * y_y - x_y * y_x, 0.0) << "z must point into the board's back";
    EXPECT_GT(x_x + x_y, 0.0) << "x must point right or down";
  }
}

TEST(Board, GivesNothingWhenThereIsNone) {
  const BoardConfig chess;
  cv::Mat empty(240, 320, CV_8UC1, cv::Scalar(128));
  EXPECT_FALSE(find_board(picture_of(empty), chess));
  EXPECT_FALSE(find_board(GreyPicture{}, chess));
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
           [](BoardConfig& b) { b.margin_m = -1.0; }}) {
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

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

geometry::CameraIntrinsics tube_lens() {
  geometry::CameraIntrinsics camera;
  camera.fc_px = {221.5, 221.9};
  camera.cc_px = {161.3, 118.2};
  camera.kc = {-0.105, 0.018, 0.0006, -0.0004, 0.0};
  return camera;
}

NamedView look_at(const Eigen::Isometry3d& T_camera_board, double noise_px,
                  simulation::Random& random, const std::string& name = "view") {
  const BoardConfig board;
  const geometry::CameraModel model(tube_lens());
  NamedView view{name, {}};
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Eigen::Vector2d place(column * board.square_m, row * board.square_m);
      const auto pixel = model.project(T_camera_board * Eigen::Vector3d(place.x(), place.y(), 0.0));
      view.view.corners_m.push_back(place);
      view.view.corners_px.push_back(
          {pixel->x() + random.normal(0.0, noise_px), pixel->y() + random.normal(0.0, noise_px)});
    }
  }
  return view;
}

std::vector<NamedView> views_of(int num, double noise_px, std::uint64_t seed,
                                const simulation::BoardMotionConfig& motion = {}) {
  simulation::Random random(seed);
  std::vector<NamedView> views;
  for (const auto& pose : simulation::show_board(tube_lens(), BoardConfig{}, num, motion, random)) {
    views.push_back(look_at(pose, noise_px, random, "view " + std::to_string(views.size())));
  }
  return views;
}

CameraCalibration calibrate(const std::vector<NamedView>& views) {
  return calibrate_camera(views, 320, 240);
}

TEST(CameraCalibration, WithoutNoiseTheLensIsFoundExactly) {
  const CameraCalibration found = calibrate(views_of(15, 0.0, 1));
  const geometry::CameraIntrinsics truth = tube_lens();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(found.intrinsics.fc_px[i], truth.fc_px[i], 1e-2);
    EXPECT_NEAR(found.intrinsics.cc_px[i], truth.cc_px[i], 1e-2);
  }
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found.intrinsics.kc[i], truth.kc[i], 1e-4);
  EXPECT_EQ(found.intrinsics.kc[4], 0.0);
  EXPECT_LT(found.rms_px, 1e-3);
}

TEST(CameraCalibration, ItsStandardDeviationsAreWhatNoiseDoes) {
  // 30 calibrations: the errors over their stated deviations have a mean square of 1
  constexpr double kNoise_px = 0.2;
  double squares = 0.0, rms_px = 0.0;
  int inside = 0, count = 0;
  const geometry::CameraIntrinsics truth = tube_lens();
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const CameraCalibration found = calibrate(views_of(12, kNoise_px, seed));
    rms_px += found.rms_px / 30.0;
    const auto add = [&](double value, double true_value, double sd) {
      const double z = (value - true_value) / sd;
      squares += z * z;
      inside += std::abs(z) < 1.96;
      ++count;
    };
    for (std::size_t i = 0; i < 2; ++i) {
      add(found.intrinsics.fc_px[i], truth.fc_px[i], found.fc_sd_px[i]);
      add(found.intrinsics.cc_px[i], truth.cc_px[i], found.cc_sd_px[i]);
    }
    for (std::size_t i = 0; i < 4; ++i) add(found.intrinsics.kc[i], truth.kc[i], found.kc_sd[i]);
  }
  EXPECT_NEAR(rms_px, kNoise_px * std::sqrt(2.0), 0.03);  // of distances: both directions
  EXPECT_GT(squares / count, 0.75);
  EXPECT_LT(squares / count, 1.30);
  EXPECT_GT(inside, 0.91 * count);
  EXPECT_LT(inside, 0.98 * count);
}

TEST(CameraCalibration, AViewThatDisagreesIsLeftOutAndNamed) {
  std::vector<NamedView> views = views_of(15, 0.1, 3);
  const CameraCalibration clean = calibrate(views);
  simulation::Random random(4);
  for (Eigen::Vector2d& corner : views[6].view.corners_px) corner.x() += random.normal(0.0, 3.0);
  const CameraCalibration found = calibrate(views);
  EXPECT_EQ(found.num_views, clean.num_views - 1);
  ASSERT_EQ(found.views.size(), views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(found.views[i].name, views[i].name);
    EXPECT_EQ(found.views[i].used, i != 6) << i;
  }
  EXPECT_GT(found.views[6].rms_px, 1.0);
  EXPECT_NEAR(found.intrinsics.fc_px[0], clean.intrinsics.fc_px[0], 1.0);
  EXPECT_EQ(found.corners_px.size(), static_cast<std::size_t>(found.num_corners));
}

TEST(CameraCalibration, TooFewViewsAreRefused) {
  EXPECT_THROW(calibrate(views_of(2, 0.1, 1)), std::runtime_error);
  EXPECT_THROW(calibrate({}), std::runtime_error);
}

TEST(CameraVerdict, GoodViewsPass) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    EXPECT_THAT(rejection_reasons(calibrate(views_of(25, 0.1, seed))), IsEmpty()) << seed;
  }
}

/// The reasons against views that lack one thing; the words must be among them.
void expect_reason(const std::vector<NamedView>& views, const std::string& words) {
  const std::vector<std::string> reasons = rejection_reasons(calibrate(views));
  EXPECT_THAT(reasons, testing::Contains(HasSubstr(words)));
}

TEST(CameraVerdict, NamesWhatIsMissing) {
  expect_reason(views_of(8, 0.1, 21), "too few views: 8");

  simulation::BoardMotionConfig flat;
  flat.tilt_max_rad = 0.08;
  expect_reason(views_of(25, 0.1, 22, flat), "tilt is too small");

  simulation::BoardMotionConfig middle;
  middle.reach = 0.1;
  middle.size_min = 0.25;
  middle.size_max = 0.35;
  expect_reason(views_of(25, 0.1, 23, middle),
                "upper left, upper right, lower left, lower right corners");
  expect_reason(views_of(25, 0.1, 23, middle), "% of the picture was covered");

  expect_reason(views_of(25, 2.0, 24), "reprojection error is too large");
}

TEST(CameraVerdict, NamesTheOneCornerThatWasNeverSeen) {
  std::vector<NamedView> views;
  for (const NamedView& view : views_of(40, 0.1, 31)) {
    bool lower_right = false;
    for (const Eigen::Vector2d& corner : view.view.corners_px) {
      lower_right = lower_right || (corner.x() > 255.0 && corner.y() > 191.0);
    }
    if (!lower_right) views.push_back(view);
  }
  ASSERT_GT(views.size(), 15u);
  EXPECT_THAT(rejection_reasons(calibrate(views)),
              ElementsAre(HasSubstr("in the lower right corner of")));
}

TEST(CameraVerdict, NamesTiltsToTwoSidesOnlyAndOneDistance) {
  simulation::Random random(41);
  const Eigen::Vector3d middle_board(0.105, 0.075, 0.0);
  std::vector<NamedView> sideways, one_distance;
  for (int i = 0; i < 24; ++i) {
    const double tilt_rad = (i % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.3, 0.7);
    const double z_m = random.uniform(0.25, 0.45);
    for (const bool at_one_distance : {false, true}) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      const bool upright = !at_one_distance || i % 4 < 2;
      pose.linear() =
          Eigen::AngleAxisd(tilt_rad, upright ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX())
              .toRotationMatrix();
      const double z = at_one_distance ? 0.4 : z_m;
      pose.translation() = Eigen::Vector3d((i % 3 - 1) * 0.06, (i / 3 % 3 - 1) * 0.04, z) -
                           pose.linear() * middle_board;
      (at_one_distance ? one_distance : sideways).push_back(look_at(pose, 0.1, random));
    }
  }
  expect_reason(sideways, "never tilted up and down");
  expect_reason(one_distance, "all views are at one distance (0.4");
}

TEST(CameraVerdict, KnowsALensThatCannotBe) {
  CameraCalibration found = calibrate(views_of(25, 0.1, 51));
  found.intrinsics.kc = {-0.9, 0.0, 0.0, 0.0, 0.0};
  EXPECT_THAT(rejection_reasons(found), ElementsAre(HasSubstr("not invertible")));
  found = calibrate(views_of(25, 0.1, 51));
  found.intrinsics.cc_px[0] = 20.0;
  EXPECT_THAT(rejection_reasons(found),
              ElementsAre(HasSubstr("far from the middle of the picture")));
  found = calibrate(views_of(25, 0.1, 51));
  found.intrinsics.fc_px[0] *= 1.3;
  EXPECT_THAT(rejection_reasons(found), ElementsAre(HasSubstr("two focal lengths differ")));
  found = calibrate(views_of(25, 0.1, 51));
  found.fc_sd_px[1] = 5.0;
  found.cc_sd_px[1] = 9.0;
  EXPECT_THAT(rejection_reasons(found),
              ElementsAre(HasSubstr("focal length is uncertain by 2.3 %"),
                          HasSubstr("principal point is uncertain by 9.0 px")));
}

TEST(ViewSelection, TakesDifferentViewsAndIsRepeatable) {
  std::vector<NamedView> views;
  const std::vector<NamedView> different = views_of(12, 0.0, 61);
  simulation::Random random(62);
  for (const NamedView& view : different) {
    for (int i = 0; i < 20; ++i) {  // held still
      views.push_back(view);
      for (Eigen::Vector2d& corner : views.back().view.corners_px) {
        corner.x() += random.normal(0.0, 0.1);
      }
    }
  }
  const auto selected = select_spread(views, 320, 240, different.size());
  ASSERT_EQ(selected.size(), different.size());
  for (std::size_t i = 0; i < selected.size(); ++i) EXPECT_EQ(selected[i] / 20, i);
  EXPECT_EQ(select_spread(views, 320, 240, different.size()), selected);
  EXPECT_EQ(select_spread(different, 320, 240, 40).size(), different.size());
}

}  // namespace

}  // namespace orchard::calibration
