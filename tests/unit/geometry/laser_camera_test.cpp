// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/laser_camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace orchard::geometry {
namespace {

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
