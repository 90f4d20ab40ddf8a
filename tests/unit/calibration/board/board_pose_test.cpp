// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "unit/central_difference.hpp"

namespace orchard::calibration {
namespace {

// Its covariance is (J^T J)^-1 of the corners by (rotation, shift): J by central differences of a
// pinhole camera, which is what undistorted corners are.
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
