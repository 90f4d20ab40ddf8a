// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <random>

#include "geometry/camera_model.hpp"

namespace orchard::geometry {
namespace {

CameraIntrinsics webcam() {
  CameraIntrinsics intrinsics;
  intrinsics.fc_px = {258.3, 256.9};
  intrinsics.cc_px = {161.2, 117.8};
  intrinsics.kc = {-0.12, 0.08, 0.0011, -0.0007, -0.01};
  return intrinsics;
}

// Eqs. 3-7 without skew are OpenCV's model, so OpenCV is the truth.
TEST(CameraModel, AgreesWithOpenCvAtZeroSkew) {
  const CameraIntrinsics intrinsics = webcam();
  const CameraModel model(intrinsics);
  const cv::Matx33d K(intrinsics.fc_px[0], 0, intrinsics.cc_px[0], 0, intrinsics.fc_px[1],
                      intrinsics.cc_px[1], 0, 0, 1);
  const cv::Mat kc(1, 5, CV_64F, const_cast<double*>(intrinsics.kc.data()));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> lateral(-0.6, 0.6), depth_m(0.3, 6.0);
  for (int i = 0; i < 200; ++i) {
    const double z_m = depth_m(random);
    const Eigen::Vector3d p_camera(lateral(random) * z_m, lateral(random) * z_m, z_m);
    std::vector<cv::Point2d> expected;
    cv::projectPoints(std::vector<cv::Point3d>{{p_camera.x(), p_camera.y(), p_camera.z()}},
                      cv::Vec3d::zeros(), cv::Vec3d::zeros(), K, kc, expected);
    const auto pixel = model.project(p_camera);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[0].x, 1e-9);
    EXPECT_NEAR(pixel->y(), expected[0].y, 1e-9);
  }
}

TEST(CameraModel, SkewShiftsTheColumnByTheDistortedRow) {
  CameraIntrinsics intrinsics = webcam();
  const auto straight = CameraModel(intrinsics).project({0.2, 0.3, 1.0});
  intrinsics.alpha_c = 0.01;
  const auto skewed = CameraModel(intrinsics).project({0.2, 0.3, 1.0});
  const double y_distorted = (straight->y() - intrinsics.cc_px[1]) / intrinsics.fc_px[1];
  EXPECT_NEAR(skewed->x() - straight->x(), intrinsics.fc_px[0] * 0.01 * y_distorted, 1e-12);
  EXPECT_DOUBLE_EQ(skewed->y(), straight->y());
}

TEST(CameraModel, RefusesPointsBehindAndBeyondTheFold) {
  const CameraModel model(webcam());
  EXPECT_FALSE(model.project({0.0, 0.0, -1.0}));
  EXPECT_FALSE(model.project({0.0, 0.0, 0.0}));
  // Barrel distortion alone turns back where 1 + 3 k1 r^2 = 0: here at r = 1.29.
  CameraIntrinsics barrel = webcam();
  barrel.kc = {-0.2, 0, 0, 0, 0};
  EXPECT_TRUE(CameraModel(barrel).project({1.28, 0.0, 1.0}));
  EXPECT_FALSE(CameraModel(barrel).project({1.30, 0.0, 1.0}));
}

TEST(CameraModel, UndistortInvertsProject) {
  const CameraModel model(webcam());
  for (double x = -0.6; x <= 0.6; x += 0.1) {
    for (double y = -0.45; y <= 0.45; y += 0.1) {
      const auto pixel = model.project({x, y, 1.0});
      ASSERT_TRUE(pixel);
      const Eigen::Vector2d normalized = model.undistort(*pixel);
      EXPECT_NEAR(normalized.x(), x, 1e-8);
      EXPECT_NEAR(normalized.y(), y, 1e-8);
    }
  }
}

const double kQuarterTurn = 1.5707963267948966;

// Eq. 2 stands for (Rx Ry Rz)^T, built here from elementary rotations.
TEST(PaperRotation, IsTheTransposedProductOfTheThreeAxisRotations) {
  const std::array<double, 3> phi_rad{1.47, -0.08, 1.66};
  const Eigen::Matrix3d product = (Eigen::AngleAxisd(phi_rad[0], Eigen::Vector3d::UnitX()) *
                                   Eigen::AngleAxisd(phi_rad[1], Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(phi_rad[2], Eigen::Vector3d::UnitZ()))
                                      .toRotationMatrix();
  EXPECT_TRUE(paper_rotation(phi_rad).isApprox(product.transpose(), 1e-14));
}

TEST(LaserToCamera, QuarterTurnsTakeForwardLeftUpToDepthRightDown) {
  const LaserToCamera to_camera({{0.0, -0.06, 0.01}, {kQuarterTurn, 0.0, kQuarterTurn}});
  const Eigen::Vector3d delta_m(0.0, -0.06, 0.01);
  EXPECT_TRUE(to_camera({1, 0, 0}).isApprox(Eigen::Vector3d(0, 0, 1) + delta_m, 1e-14));
  EXPECT_TRUE(to_camera({0, 1, 0}).isApprox(Eigen::Vector3d(-1, 0, 0) + delta_m, 1e-14));
  EXPECT_TRUE(to_camera({0, 0, 1}).isApprox(Eigen::Vector3d(0, -1, 0) + delta_m, 1e-14));
}

TEST(LaserToCamera, InvertsEquation1) {
  const LaserCameraExtrinsics extrinsics{{0.03, -0.08, 0.02}, {1.5, 0.04, 1.6}};
  const LaserToCamera to_camera(extrinsics);
  const Eigen::Vector3d p_laser(2.0, -0.7, 0.0);
  const Eigen::Vector3d delta_m(0.03, -0.08, 0.02);
  const Eigen::Vector3d back = paper_rotation(extrinsics.phi_rad) * (to_camera(p_laser) - delta_m);
  EXPECT_TRUE(back.isApprox(p_laser, 1e-14));
}

}  // namespace
}  // namespace orchard::geometry
