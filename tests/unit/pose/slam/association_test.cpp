// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/association.hpp"
#include "geometry/pose2.hpp"

#include <gtest/gtest.h>

namespace orchard::pose {
using geometry::inverse_transform;
using geometry::transform;

namespace {

/// Two rows 4 m apart, a tree every 2 m, one gap, the robot between them at the middle.
struct Rows {
  std::vector<AssociationCandidate> candidates;
  std::vector<ScanPoint> points;

  explicit Rows(bool gap, const Eigen::Vector3d& T_map_base = Eigen::Vector3d::Zero()) {
    for (int i = -6; i <= 6; ++i) {
      for (const double y_m : {-2.0, 2.0}) {
        if (gap && i == 1 && y_m > 0.0) continue;
        AssociationCandidate c;
        c.landmark = static_cast<int>(candidates.size()) + 100;
        c.p_map = {2.0 * i, y_m};
        c.covariance = 0.03 * 0.03 * Eigen::Matrix2d::Identity();
        c.width_m = 0.12;
        c.width_sd_m = 0.01;
        candidates.push_back(c);
        const Eigen::Vector2d p_base = inverse_transform(T_map_base, c.p_map);
        if (p_base.norm() < 5.6) points.push_back(point(p_base));
      }
    }
  }
  static ScanPoint point(const Eigen::Vector2d& p_base, double width_m = 0.12) {
    ScanPoint p;
    p.p_base = p_base;
    p.covariance = p.scan_covariance = 0.03 * 0.03 * Eigen::Matrix2d::Identity();
    p.width_m = width_m;
    p.width_sd_m = 0.02;
    return p;
  }
  const Eigen::Vector2d& place(int landmark) const { return candidates[landmark - 100].p_map; }
};

Eigen::Matrix3d pose_covariance(double sd_m, double sd_rad) {
  return Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad).asDiagonal();
}

void expect_right(const Rows& rows, const Association& a, const Eigen::Vector3d& T_map_base) {
  EXPECT_FALSE(a.ambiguous);
  for (std::size_t p = 0; p < rows.points.size(); ++p) {
    ASSERT_GE(a.landmark[p], 0);
    const Eigen::Vector2d p_map = transform(T_map_base, rows.points[p].p_base);
    EXPECT_LT((rows.place(a.landmark[p]) - p_map).norm(), 0.01);
  }
}

TEST(Associate, FindsAllWhenThePoseIsNearlyRight) {
  const Rows rows(false);
  const auto a = associate(rows.points, rows.candidates, {0.1, -0.1, 0.02},
                           pose_covariance(0.1, 0.03), SlamConfig{});
  expect_right(rows, a, Eigen::Vector3d::Zero());
  EXPECT_LT(a.T_map_base.norm(), 0.02);
}

TEST(Associate, AShiftByMoreThanHalfATreeIsResolvedByTheGap) {
  // nearest neighbours alone would take the next tree for every point
  const Rows rows(true);
  const auto a = associate(rows.points, rows.candidates, {1.15, 0.0, 0.0},
                           pose_covariance(0.6, 0.03), SlamConfig{});
  expect_right(rows, a, Eigen::Vector3d::Zero());
}

TEST(Associate, WithoutAGapAShiftByOneIsAmbiguousAndNothingIsMatched) {
  const Rows rows(false);
  const auto a = associate(rows.points, rows.candidates, {1.0, 0.0, 0.0},
                           pose_covariance(0.6, 0.03), SlamConfig{});
  EXPECT_TRUE(a.ambiguous);
  EXPECT_EQ(a.num_matched, 0);
}

TEST(Associate, ATurnIsFoundJointly) {
  // at 5 m a tenth of a radian is half a metre: no pair fits alone as it is predicted
  const Eigen::Vector3d truth(0.0, 0.0, 0.1);
  const Rows rows(true, truth);
  const auto a = associate(rows.points, rows.candidates, Eigen::Vector3d::Zero(),
                           pose_covariance(0.05, 0.08), SlamConfig{});
  expect_right(rows, a, truth);
  EXPECT_NEAR(a.T_map_base.z(), 0.1, 0.01);
}

TEST(Associate, WhatIsTooWideIsAnotherThing) {
  Rows rows(false);
  rows.points[0].width_m = 0.6;
  const auto a = associate(rows.points, rows.candidates, Eigen::Vector3d::Zero(),
                           pose_covariance(0.05, 0.02), SlamConfig{});
  EXPECT_EQ(a.landmark[0], -1);
  EXPECT_FALSE(a.is_new[0]);  // it stands where a landmark stands
  EXPECT_GE(a.landmark[1], 0);
}

TEST(Associate, WhatStandsFreeIsNewAndWalkersDoNotPullTheRest) {
  Rows rows(true);
  rows.points.push_back(Rows::point({1.0, 0.5}));
  rows.points.push_back(Rows::point({-2.0, 1.7}));  // beside a tree: 0.3 m from it
  const auto a = associate(rows.points, rows.candidates, Eigen::Vector3d::Zero(),
                           pose_covariance(0.1, 0.03), SlamConfig{});
  const std::size_t n = rows.points.size();
  EXPECT_TRUE(a.is_new[n - 2]);
  EXPECT_EQ(a.landmark[n - 1], -1);
  EXPECT_FALSE(a.is_new[n - 1]);
  EXPECT_LT(a.T_map_base.norm(), 0.02);
}

TEST(Associate, NothingToMatchIsNoError) {
  const Rows rows(false);
  const auto nothing =
      associate({}, rows.candidates, Eigen::Vector3d::Zero(), pose_covariance(1, 1), SlamConfig{});
  EXPECT_EQ(nothing.num_matched, 0);
  const auto first =
      associate(rows.points, {}, Eigen::Vector3d::Zero(), pose_covariance(1, 1), SlamConfig{});
  EXPECT_EQ(first.num_matched, 0);
  EXPECT_TRUE(first.is_new[0]);
}

}  // namespace
}  // namespace orchard::pose
