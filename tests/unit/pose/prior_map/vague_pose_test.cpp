// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/vague_pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "unit/central_difference.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;
using test::central_difference;

const Eigen::Vector3d kStart(3.0, 2.0, 0.4);

Eigen::Matrix3d start_covariance() {
  const Eigen::Matrix3d A =
      (Eigen::Matrix3d() << 0.1, 0, 0, -0.03, 0.08, 0, 0.01, 0.02, 0.03).finished();
  return A * A.transpose();
}

/// Trees here and there, far enough from one another that each trunk can be one of them only.
const std::vector<Eigen::Vector2d>& scattered() {
  static const std::vector<Eigen::Vector2d> trees{{6.0, 3.0},  {1.0, 6.5},  {-2.0, 1.0},
                                                  {4.0, -2.5}, {8.5, -1.0}, {7.0, 7.5}};
  return trees;
}

PriorMap map_of(const std::vector<Eigen::Vector2d>& trees) {
  std::vector<PriorLandmark> landmarks;
  for (const Eigen::Vector2d& p : trees) landmarks.push_back({p});
  return PriorMap(landmarks, 20.0);
}

/// A trunk of the local map at a point of the prior map, seen from a pose.
LocalTrunkMap::Trunk trunk_at(const Eigen::Vector2d& p_map, const Eigen::Vector3d& T_map_base) {
  LocalTrunkMap::Trunk trunk;
  trunk.p_local = geometry::inverse_transform(T_map_base, p_map);
  trunk.covariance = 4e-4 * Eigen::Matrix2d::Identity();
  return trunk;
}

double sd(const VaguePose& pose, int axis) { return std::sqrt(pose.covariance()(axis, axis)); }

TEST(VaguePose, AMotionCarriesTheCovarianceAsTheCentralDifferencesDo) {
  const Eigen::Vector3d next(0.8, -0.1, 0.3);
  const PriorMap map = map_of(scattered());
  VaguePose pose(map);
  pose.start(kStart, start_covariance());
  pose.move(next, 0.2 * start_covariance());
  const auto by_pose = [&](const Eigen::VectorXd& x) { return compose(Eigen::Vector3d(x), next); };
  const auto by_motion = [&](const Eigen::VectorXd& x) {
    return compose(kStart, Eigen::Vector3d(x));
  };
  const Eigen::MatrixXd F = central_difference(by_pose, kStart).J;
  const Eigen::MatrixXd G = central_difference(by_motion, next).J;
  EXPECT_LT((pose.T_map_base() - compose(kStart, next)).norm(), 1e-12);
  EXPECT_LT((pose.covariance() - F * start_covariance() * F.transpose() -
             G * 0.2 * start_covariance() * G.transpose())
                .norm(),
            1e-9);
}

TEST(VaguePose, TrunksOfTheMapPullItThereAndMakeItNoSurerThanLeastSquaresDo) {
  const PriorMap map = map_of(scattered());
  const Eigen::Vector3d truth = kStart + Eigen::Vector3d(0.10, -0.06, 0.02);
  VaguePose pose(map);
  pose.start(kStart, start_covariance());
  std::vector<LocalTrunkMap::Trunk> trunks;
  for (const Eigen::Vector2d& p : scattered()) trunks.push_back(trunk_at(p, truth));
  for (int i = 0; i < 20; ++i) pose.correct(trunks, 0.05);
  EXPECT_LT((pose.T_map_base() - truth).head<2>().norm(), 0.03);
  EXPECT_NEAR(pose.T_map_base().z(), truth.z(), 0.01);

  // The normal equations with partners known, each trunk once.
  Eigen::Matrix3d A = start_covariance().inverse();
  const double variance_m2 = 4e-4 + std::pow(PriorMapConfig::kLandmarkSd_m, 2);
  for (const LocalTrunkMap::Trunk& trunk : trunks) {
    const auto place = [&](const Eigen::VectorXd& x) {
      return geometry::transform(Eigen::Vector3d(x), trunk.p_local);
    };
    const Eigen::MatrixXd H = central_difference(place, truth).J;
    A += H.transpose() * H / variance_m2;
  }
  const Eigen::Matrix3d P = A.inverse();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(sd(pose, axis), 0.9 * std::sqrt(P(axis, axis))) << axis;
    EXPECT_LT(sd(pose, axis), 2.0 * std::sqrt(P(axis, axis))) << axis;
  }
}

TEST(VaguePose, WhatIsNotInTheMapDoesNotMakeItSure) {
  const PriorMap map = map_of(scattered());
  VaguePose pose(map);
  pose.start(kStart, start_covariance());
  std::vector<LocalTrunkMap::Trunk> leaves;
  for (int i = 0; i < 12; ++i) leaves.push_back(trunk_at({3.0 + 0.3 * i, 0.3}, kStart));
  for (int i = 0; i < 20; ++i) pose.correct(leaves, 0.05);
  EXPECT_LT((pose.T_map_base() - kStart).norm(), 0.02);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(sd(pose, axis), 0.9 * std::sqrt(start_covariance()(axis, axis))) << axis;
  }
}

TEST(VaguePose, BetweenTwoPlacesThatFitItIsAsUnsureAsTheyAreApart) {
  // A row of trees 0.7 m apart along x, and the robot half a spacing from where it thinks.
  std::vector<Eigen::Vector2d> trees;
  for (int i = -12; i <= 12; ++i) trees.push_back({0.7 * i, 1.0});
  const PriorMap map = map_of(trees);
  VaguePose pose(map);
  pose.start(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.09, 0.01, 1e-4).asDiagonal());
  std::vector<LocalTrunkMap::Trunk> trunks;
  for (int i = -4; i <= 4; ++i) {
    trunks.push_back(trunk_at({0.7 * i + 0.35, 1.0}, Eigen::Vector3d::Zero()));
  }
  for (int i = 0; i < 10; ++i) pose.correct(trunks, 0.1);
  EXPECT_NEAR(pose.T_map_base().x(), 0.0, 0.02);
  EXPECT_GT(sd(pose, 0), 0.30);
  EXPECT_LT(sd(pose, 1), 0.06);
}

}  // namespace
}  // namespace orchard::pose
