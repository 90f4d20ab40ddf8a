// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/laser_camera_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <string>
#include <vector>

#include "calibration/board/board_pose.hpp"
#include "geometry/camera_model.hpp"
#include "unit/central_difference.hpp"

namespace orchard::calibration {
namespace {

using ::testing::HasSubstr;

constexpr double kDeg = 3.14159265358979323846 / 180.0;
const BoardOutline kOutline{-0.12, -0.12, 0.60, 0.44};

RigidExtrinsics
upright() {  // laser forward, left, up = camera z, -x, -y; 6 cm above it, a little turned
  Eigen::Matrix3d R;
  R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::AngleAxisd off(2.0 * kDeg, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
  return {off.toRotationMatrix() * R, {0.01, -0.06, -0.02}};
}

RigidExtrinsics turned_about_view(const RigidExtrinsics& mount, double angle_deg) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle_deg * kDeg, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return {turn * mount.R_camera_laser, turn * mount.delta_m};
}

/// Exact beams on a board, cut by the sheet's edges: intersections of rays and a plane, none of the
/// code under test.
ExtrinsicsView view_of(const RigidExtrinsics& mount, double yaw_deg, double pitch_deg,
                       double roll_deg, double range_m, double side_m) {
  // the board's middle lies in the scan plane; its axes in the laser frame: x right, y down, z away
  Eigen::Matrix3d upright_board;
  upright_board << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d R_laser_board =
      upright_board * (Eigen::AngleAxisd(yaw_deg * kDeg, Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(pitch_deg * kDeg, Eigen::Vector3d::UnitX()) *
                       Eigen::AngleAxisd(roll_deg * kDeg, Eigen::Vector3d::UnitZ()))
                          .toRotationMatrix();
  const Eigen::Vector3d middle_board(0.24, 0.16, 0.0);
  const Eigen::Vector3d t_laser_board =
      Eigen::Vector3d(range_m, side_m, 0.03) - R_laser_board * middle_board;
  ExtrinsicsView view;
  view.board.R_camera_board = mount.R_camera_laser * R_laser_board;
  view.board.t_camera_board_m = mount.R_camera_laser * t_laser_board + mount.delta_m;
  view.board.covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-7, 1e-7, 1e-7;
  BoardLine line;
  const Eigen::Vector3d n = R_laser_board.col(2);
  const double step_rad = 0.0061;
  for (int i = -200; i <= 200; ++i) {
    const double bearing_rad = i * step_rad;
    const Eigen::Vector3d ray(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
    const double beam_m = n.dot(t_laser_board) / n.dot(ray);
    const Eigen::Vector3d p = R_laser_board.transpose() * (beam_m * ray - t_laser_board);
    if (beam_m <= 0.0 || p.x() < kOutline.x_min_m || p.x() > kOutline.x_max_m ||
        p.y() < kOutline.y_min_m || p.y() > kOutline.y_max_m) {
      continue;
    }
    line.ranges_m.push_back(beam_m);
    line.bearings_rad.push_back(bearing_rad);
  }
  const auto point = [&](std::size_t i) {
    return Eigen::Vector2d(line.ranges_m[i] * std::cos(line.bearings_rad[i]),
                           line.ranges_m[i] * std::sin(line.bearings_rad[i]));
  };
  const Eigen::Vector2d first = point(0), last = point(line.ranges_m.size() - 1);
  line.middle_m = 0.5 * (first + last);
  line.direction = (last - first).normalized();
  line.length_m = (last - first).norm();
  view.lines.push_back(line);
  return view;
}

/// A wall that stands still, of the board's length.
BoardLine cupboard() {
  BoardLine line;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d p(2.2 + 0.003 * i, 0.9 + 0.0135 * i);
    line.ranges_m.push_back(p.norm());
    line.bearings_rad.push_back(std::atan2(p.y(), p.x()));
  }
  line.middle_m = {2.27, 1.23};
  line.direction = Eigen::Vector2d(0.003, 0.0135).normalized();
  line.length_m = 0.68;
  return line;
}

std::vector<ExtrinsicsView> careful_views(const RigidExtrinsics& mount) {
  std::vector<ExtrinsicsView> views;
  for (int i = 0; i < 16; ++i) {
    const double yaw_deg = 32.0 * std::sin(2.4 * i), pitch_deg = 30.0 * std::cos(1.7 * i + 0.4);
    views.push_back(view_of(mount, yaw_deg, pitch_deg, 12.0 * std::sin(1.1 * i),
                            0.9 + 0.06 * ((7 * i) % 16), 0.3 * std::sin(0.9 * i)));
    views.back().lines.insert(views.back().lines.begin(), cupboard());
  }
  return views;
}

LaserCameraCalibration calibrate(const std::vector<ExtrinsicsView>& views) {
  LaserCameraOptions options;
  options.noise = {0.003, 0.003, 0.004, 0.002};
  return calibrate_laser_camera(views, kOutline, options);
}

void expect_mount(const RigidExtrinsics& found, const RigidExtrinsics& truth) {
  EXPECT_LT((found.delta_m - truth.delta_m).norm(), 1e-4);
  EXPECT_LT(Eigen::AngleAxisd(found.R_camera_laser.transpose() * truth.R_camera_laser).angle(),
            1e-4);
}

TEST(LaserCameraCalibration, ExactDataGiveTheExactMountAmongStandingClutter) {
  const auto result = calibrate(careful_views(upright()));
  ASSERT_EQ(result.refusal, "");
  expect_mount(result.mount, upright());
  EXPECT_EQ(result.num_used, 16);
  for (const auto& view : result.views) EXPECT_EQ(view.line, 1);
  const geometry::LaserToCamera T(result.extrinsics);
  EXPECT_LT((T.rotation() - result.mount.R_camera_laser).norm(), 1e-9);
}

TEST(LaserCameraCalibration, AWrongSquareSizeIsRefusedAndTheTrueOneNamed) {
  for (const double stated_of_true : {0.8, 0.85, 0.9, 0.95, 1.05, 1.1, 1.2}) {
    // pictures tell the board's distance in its squares: all distances are as wrong as they are
    auto views = careful_views(upright());
    for (ExtrinsicsView& view : views) {
      view.board.t_camera_board_m *= stated_of_true;
      view.board.covariance.diagonal().tail<3>() *= stated_of_true * stated_of_true;
    }
    LaserCameraOptions options;
    options.noise = {0.003, 0.003, 0.004, 0.002};
    const BoardOutline stated{stated_of_true * kOutline.x_min_m, stated_of_true * kOutline.y_min_m,
                              stated_of_true * kOutline.x_max_m, stated_of_true * kOutline.y_max_m};
    const auto result = calibrate_laser_camera(views, stated, options);
    EXPECT_THAT(result.refusal, HasSubstr("of its stated size")) << stated_of_true;
    EXPECT_NEAR(result.board_scale * stated_of_true, 1.0, 0.02) << stated_of_true;
  }
}

TEST(LaserCameraCalibration, AnUpsideDownOrPortraitCameraComesOutRight) {
  for (const double angle_deg : {180.0, 90.0, -90.0}) {
    const RigidExtrinsics truth = turned_about_view(upright(), angle_deg);
    const auto result = calibrate(careful_views(truth));
    ASSERT_EQ(result.refusal, "") << angle_deg;
    expect_mount(result.mount, truth);
  }
}

TEST(LaserCameraCalibration, AViewThatContradictsTheRestIsNamed) {
  auto views = careful_views(upright());
  for (double& range_m : views[5].lines[1].ranges_m) range_m += 0.035;
  views[5].lines[1].middle_m *= 1.03;
  const auto result = calibrate(views);
  ASSERT_EQ(result.refusal, "");
  EXPECT_NE(result.views[5].status, LaserCameraView::ViewStatus::kUsed);
  EXPECT_EQ(result.num_used, 15);
}

struct Degenerate {
  const char* name;
  double yaw_deg, pitch_deg;  ///< amplitudes
  const char* reason;
};

TEST(LaserCameraCalibration, EachDegenerateSetIsRefusedWithItsReason) {
  const RigidExtrinsics mount = upright();
  for (const Degenerate& set : std::vector<Degenerate>{
           {"parallel", 0.3, 0.3, "parallel to itself"},
           {"small tilts", 4.0, 4.0, "parallel to itself"},
           {"turned only", 35.0, 0.3, "about one axis only, the camera's y axis"},
           {"leaned only", 0.3, 35.0, "about one axis only, the camera's x axis"}}) {
    std::vector<ExtrinsicsView> views;
    for (int i = 0; i < 16; ++i) {
      views.push_back(view_of(mount, set.yaw_deg * std::sin(2.4 * i),
                              set.pitch_deg * std::cos(1.7 * i + 0.4), 10.0 * std::sin(1.1 * i),
                              0.9 + 0.06 * ((7 * i) % 16), 0.3 * std::sin(0.9 * i)));
    }
    EXPECT_THAT(calibrate(views).refusal, HasSubstr(set.reason)) << set.name;
  }
  std::vector<ExtrinsicsView> two, one, still;
  for (int i = 0; i < 16; ++i) {
    two.push_back(view_of(mount, i % 2 ? 25 : -20, i % 2 ? -15 : 20, 3, 0.9 + 0.05 * i, 0));
    still.push_back(view_of(mount, 20, 10, 0, 1.2, 0));
  }
  EXPECT_THAT(calibrate(two).refusal, HasSubstr("two orientations only"));
  EXPECT_THAT(calibrate(still).refusal, HasSubstr("never moved"));
  auto few = careful_views(mount);
  few.resize(5);
  EXPECT_THAT(calibrate(few).refusal, HasSubstr("only 5 views"));
}

TEST(LaserCameraCalibration, ABoardThatTheScannerNeverSawIsSaidSo) {
  auto views = careful_views(upright());
  for (auto& view : views) view.lines.resize(1);  // the cupboard
  EXPECT_THAT(calibrate(views).refusal, HasSubstr("no pose of the scanner"));
  for (auto& view : views) view.lines.clear();
  EXPECT_THAT(calibrate(views).refusal, HasSubstr("the scanner found no line"));
}

TEST(MountContradiction, MirroredPicturesAreNamedAgainstTheStatedMount) {
  const RigidExtrinsics stated = upright();
  EXPECT_EQ(extrinsics_contradiction(stated, stated), "");
  // what mirrored pictures make of the boards: their planes are mirrored
  for (const auto& [mirror, words] : std::vector<std::pair<Eigen::Vector3d, const char*>>{
           {{-1, 1, 1}, "mirrored left to right"}, {{1, -1, 1}, "mirrored top to bottom"}}) {
    auto views = careful_views(stated);
    for (auto& view : views) {
      Eigen::Matrix3d& R = view.board.R_camera_board;
      R = mirror.asDiagonal() * R;
      R.col(2) = R.col(0).cross(R.col(1));
      view.board.t_camera_board_m = mirror.asDiagonal() * view.board.t_camera_board_m;
    }
    const auto result = calibrate(views);
    ASSERT_EQ(result.refusal, "");  // a plane cannot tell
    EXPECT_THAT(extrinsics_contradiction(result.mount, stated), HasSubstr(words));
  }
  EXPECT_THAT(extrinsics_contradiction(turned_about_view(stated, 90.0), stated),
              HasSubstr("rotated by 90 deg"));
}

TEST(PaperAngles, AreTheInverseOfThePapersRotation) {
  for (const std::array<double, 3>& phi :
       {std::array<double, 3>{1.5788, 0.0065, 1.5628}, {-2.9, 1.2, -0.4}, {0.3, -1.1, 3.0}}) {
    const auto found = geometry::paper_angles_rad(geometry::paper_rotation(phi).transpose());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], phi[i], 1e-12);
  }
}

TEST(BoardPose, CovarianceIsThatOfTheCentralDifferences) {
  geometry::CameraIntrinsics pinhole;
  pinhole.fc_px = {220.0, 220.0};
  pinhole.cc_px = {160.0, 120.0};
  pinhole.kc = {};
  const geometry::CameraModel camera(pinhole);
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()))
                                .toRotationMatrix();
  const Eigen::Vector3d t(-0.1, -0.08, 0.7);
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 48; ++i) places.emplace_back(0.03 * (i % 8), 0.03 * (i / 8));
  const auto corners = [&](const Eigen::VectorXd& change) {
    const double angle_rad = change.head<3>().norm();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (angle_rad > 0.0) {
      turn = Eigen::AngleAxisd(angle_rad, change.head<3>() / angle_rad).toRotationMatrix();
    }
    Eigen::VectorXd pixels(2 * places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Eigen::Vector3d on_board(places[i].x(), places[i].y(), 0.0);
      pixels.segment<2>(2 * static_cast<Eigen::Index>(i)) =
          *camera.project(turn * R * on_board + t + change.tail<3>());
    }
    return pixels;
  };
  const Eigen::VectorXd seen = corners(Eigen::VectorXd::Zero(6));
  std::vector<Eigen::Vector2d> pixels;
  for (Eigen::Index i = 0; i < seen.size(); i += 2) pixels.emplace_back(seen.segment<2>(i));
  const double sd_px = 0.2;
  const auto pose = estimate_board_pose(pixels, places, camera, sd_px);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->R_camera_board - R).norm() + (pose->t_camera_board_m - t).norm(), 1e-6);
  const Eigen::MatrixXd J = test::central_difference(corners, Eigen::VectorXd::Zero(6)).J;
  const Eigen::MatrixXd expected = sd_px * sd_px * (J.transpose() * J).inverse();
  EXPECT_LT((pose->covariance - expected).norm(), 1e-5 * expected.norm());
}

}  // namespace

}  // namespace orchard::calibration
