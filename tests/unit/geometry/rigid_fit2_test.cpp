// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/rigid_fit2.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace orchard::geometry {
namespace {

using Eigen::Vector2d;

std::vector<Vector2d> scattered(int num, std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-30.0, 30.0);
  std::vector<Vector2d> points;
  for (int i = 0; i < num; ++i) points.emplace_back(coordinate(random), coordinate(random));
  return points;
}

std::vector<Vector2d> moved(const Pose2& T_a_b, const std::vector<Vector2d>& p_b) {
  std::vector<Vector2d> p_a;
  for (const Vector2d& p : p_b) p_a.push_back(transform(T_a_b, p));
  return p_a;
}

double sum_squares_m2(const Pose2& T_a_b, const std::vector<Vector2d>& p_a,
                      const std::vector<Vector2d>& p_b, const std::vector<double>& weights) {
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    sum_m2 += weights[i] * (transform(T_a_b, p_b[i]) - p_a[i]).squaredNorm();
  }
  return sum_m2;
}

void expect_same(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x_m, b.x_m, tolerance);
  EXPECT_NEAR(a.y_m, b.y_m, tolerance);
  EXPECT_NEAR(wrap_angle_rad(a.yaw_rad - b.yaw_rad), 0.0, tolerance);
}

TEST(RigidFit2, FindsTheMotionThatPointsWereMovedBy) {
  std::mt19937 random(1);
  for (const Pose2& truth : {Pose2{3.0, -7.0, 2.5}, Pose2{-100.0, 40.0, -3.1}, Pose2{}}) {
    for (const int num : {2, 3, 50}) {
      const std::vector<Vector2d> p_b = scattered(num, random);
      expect_same(fit_rigid(moved(truth, p_b), p_b).T_a_b, truth, 1e-11);
    }
  }
}

TEST(RigidFit2, NoMotionNearbyHasASmallerWeightedSum) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::uniform_real_distribution<double> weight(0.1, 5.0);
  const std::vector<Vector2d> p_b = scattered(30, random);
  std::vector<Vector2d> p_a = moved({5.0, 1.0, -1.2}, p_b);
  std::vector<double> weights;
  for (Vector2d& p : p_a) {
    p += Vector2d(noise(random), noise(random));
    weights.push_back(weight(random));
  }
  const Pose2 best = fit_rigid(p_a, p_b, weights).T_a_b;
  const double least_m2 = sum_squares_m2(best, p_a, p_b, weights);
  for (const double step : {-1e-4, 1e-4}) {
    for (int k = 0; k < 3; ++k) {
      const Pose2 other{best.x_m + (k == 0) * step, best.y_m + (k == 1) * step,
                        best.yaw_rad + (k == 2) * step};
      EXPECT_GT(sum_squares_m2(other, p_a, p_b, weights), least_m2) << k;
    }
  }
}

TEST(RigidFit2, WhatHasNoWeightDoesNotCount) {
  std::mt19937 random(3);
  const Pose2 truth{1.0, 2.0, 0.4};
  std::vector<Vector2d> p_b = scattered(10, random);
  std::vector<Vector2d> p_a = moved(truth, p_b);
  p_a.back() += Vector2d(50.0, -20.0);
  std::vector<double> weights(p_b.size(), 2.0);
  weights.back() = 0.0;
  expect_same(fit_rigid(p_a, p_b, weights).T_a_b, truth, 1e-11);
}

TEST(RigidFit2, MeansAndSpread) {
  const RigidFit2 fit = fit_rigid({{10, 0}, {10, 2}}, {{0, 0}, {2, 0}}, {1.0, 3.0});
  EXPECT_NEAR((fit.mean_a - Vector2d(10.0, 1.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((fit.mean_b - Vector2d(1.5, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(fit.mean_square_b_m2, 0.25 * 2.25 + 0.75 * 0.25, 1e-12);
}

TEST(RigidFit2, OnePlaceGivesATranslation) {
  expect_same(fit_rigid({{4, 5}}, {{1, 1}}).T_a_b, {3.0, 4.0, 0.0}, 1e-12);
  expect_same(fit_rigid({{4, 5}, {4, 5}}, {{1, 1}, {1, 1}}).T_a_b, {3.0, 4.0, 0.0}, 1e-12);
}

TEST(RigidFit2, RefusesWhatIsNoPairing) {
  EXPECT_THROW(fit_rigid({}, {}), std::invalid_argument);
  EXPECT_THROW(fit_rigid({{0, 0}}, {}), std::invalid_argument);
  EXPECT_THROW(fit_rigid({{0, 0}}, {{0, 0}}, {1.0, 1.0}), std::invalid_argument);
  expect_same(fit_rigid({{4, 5}}, {{1, 1}}, {0.0}).T_a_b, {}, 0.0);
}

TEST(RigidFit2, TwoOnTwoHalvesWhatTheirLengthsDifferBy) {
  const Pose2 truth{-3.0, 8.0, 3.0};
  const Vector2d b1(1.0, 2.0), b2(5.0, 2.0);
  const Vector2d a1 = transform(truth, {0.9, 2.0}), a2 = transform(truth, {5.1, 2.0});
  expect_same(pose_from_two_pairs(a1, a2, b1, b2), truth, 1e-12);
  expect_same(pose_from_two_pairs(a1, a2, b1, b2), fit_rigid({a1, a2}, {b1, b2}).T_a_b, 1e-12);
}

}  // namespace
}  // namespace orchard::geometry
