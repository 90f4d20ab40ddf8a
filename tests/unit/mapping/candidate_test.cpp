// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/candidate.hpp"

#include <gtest/gtest.h>

#include "geometry/pose2.hpp"
#include "unit/central_difference.hpp"

namespace orchard::mapping {
namespace {

pose::PoseEstimate some_pose() {
  pose::PoseEstimate pose;
  pose.x_m = 3.0;
  pose.y_m = -2.0;
  pose.yaw_rad = 2.5;
  pose.covariance = {0.04, 0.01, -0.003, 0.03, 0.002, 0.01};
  return pose;
}

detection::Detection at(double x_m, double y_m) {
  detection::Detection d;
  d.centre_x_m = x_m;
  d.centre_y_m = y_m;
  d.covariance = {4e-4, 1e-4, 9e-4};
  return d;
}

TEST(Candidate, CovarianceIsThatOfTheCentralDifferences) {
  const pose::PoseEstimate pose = some_pose();
  detection::Detections seen;
  seen.trunks = {at(2.0, 1.0)};
  const auto candidates = compose(seen, pose, PoseComposition(pose), 10.0);
  ASSERT_EQ(candidates.size(), 1u);
  // A centre in map by the pose and by itself.
  Eigen::VectorXd x(5);
  x << pose.x_m, pose.y_m, pose.yaw_rad, 2.0, 1.0;
  const auto place = [](const Eigen::VectorXd& v) {
    return geometry::transform(Eigen::Vector3d(v.head<3>()), Eigen::Vector2d(v.tail<2>()));
  };
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(5, 5);
  P.topLeftCorner<3, 3>() << 0.04, 0.01, -0.003, 0.01, 0.03, 0.002, -0.003, 0.002, 0.01;
  P.bottomRightCorner<2, 2>() << 4e-4, 1e-4, 1e-4, 9e-4;
  const Eigen::MatrixXd J = orchard::test::central_difference(place, x).J;
  const Eigen::Matrix2d expected =
      J * P * J.transpose() + 1e-6 * Eigen::Matrix2d::Identity();  // at least a millimetre
  EXPECT_LT((candidates[0].p_map - place(x)).norm(), 1e-12);
  EXPECT_LT((candidates[0].covariance - expected).norm(), 1e-8 * expected.norm());
}

TEST(Candidate, FarOnesAndThoseWithoutAPlaceAreLeftOut) {
  const pose::PoseEstimate pose = some_pose();
  detection::Detections seen;
  seen.trunks = {at(2.0, 1.0), at(9.0, 5.0), at(std::nan(""), 1.0), at(1.0, 1.0)};
  const auto candidates = compose(seen, pose, PoseComposition(pose), 10.0);
  ASSERT_EQ(candidates.size(), 2u);
  EXPECT_EQ(candidates[1].detection, &seen.trunks[3]);
}

}  // namespace
}  // namespace orchard::mapping
