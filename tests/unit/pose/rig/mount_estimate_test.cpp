// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/mount_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;
using geometry::inverse;

const Eigen::Vector3d kMount(0.4, -0.2, 0.3);

/// Motions of about a metre, straight or in turns to both sides, seen by a scanner at kMount.
std::vector<MotionPair> motions(int num, double turn_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<MotionPair> pairs;
  for (int i = 0; i < num; ++i) {
    const double turn = i % 2 == 0 ? 0.0 : turn_rad * (i % 4 == 1 ? 1.0 : -1.0);
    const Eigen::Vector3d base(1.0, 0.5 * turn, turn);
    MotionPair pair;
    pair.reference =
        base + Eigen::Vector3d(0.005 * noise(random), 0.005 * noise(random), 0.002 * noise(random));
    pair.laser = compose(inverse(kMount), compose(base, kMount)) +
                 Eigen::Vector3d(0.01 * noise(random), 0.01 * noise(random), 0.002 * noise(random));
    pair.duration_s = 1.5;
    pairs.push_back(pair);
  }
  return pairs;
}

void expect_within(const Estimate& e, double truth, double sigmas, double most) {
  EXPECT_LT(std::abs(e.value - truth), sigmas * e.sd);
  EXPECT_LT(std::abs(e.value - truth), most);
}

TEST(MountEstimate, FindsTheMountWithAnHonestStandardDeviation) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const auto found = estimate_mount(motions(80, 0.5, seed));
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->is_mirrored);
    expect_within(found->mount_x_m, kMount.x(), 4.0, 0.03);
    expect_within(found->mount_y_m, kMount.y(), 4.0, 0.03);
    expect_within(found->mount_yaw_rad, kMount.z(), 4.0, 0.01);
    expect_within(found->way_scale, 1.0, 4.0, 0.01);
    expect_within(found->turn_scale, 1.0, 4.0, 0.01);
  }
}

TEST(MountEstimate, AWrongSixthOfTheMotionsHasNoSay) {
  std::vector<MotionPair> pairs = motions(90, 0.5, 3);
  for (std::size_t i = 0; i < pairs.size(); i += 6)
    pairs[i].laser += Eigen::Vector3d(0.6, -0.3, 0.4);
  const auto found = estimate_mount(pairs);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->mount_x_m.value, kMount.x(), 0.04);
  EXPECT_NEAR(found->mount_yaw_rad.value, kMount.z(), 0.02);
}

TEST(MountEstimate, WithoutATurnThePlaceIsNotKnownButTheDirectionIs) {
  const auto found = estimate_mount(motions(80, 0.0, 5));
  ASSERT_TRUE(found);
  EXPECT_GT(found->mount_x_m.sd, 0.3);
  EXPECT_GT(found->mount_y_m.sd, 0.3);
  EXPECT_LT(found->mount_yaw_rad.sd, 0.01);
  EXPECT_NEAR(found->mount_yaw_rad.value, kMount.z(), 0.01);
}

TEST(MountEstimate, ErrorsOfMatchingAreNoTurns) {
  // Where matched scans turn wrongly, they turn about what they see, and so err in the way, too.
  const Eigen::Vector2d p_seen(5.0, -6.0);
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error_rad(0.0, 0.003);
    std::vector<MotionPair> pairs = motions(150, 0.0, seed);
    for (MotionPair& pair : pairs) {
      const double turn = error_rad(random);
      pair.laser += Eigen::Vector3d(turn * p_seen.y(), -turn * p_seen.x(), turn);
    }
    const auto found = estimate_mount(pairs);
    ASSERT_TRUE(found);
    expect_within(found->mount_x_m, kMount.x(), 3.0, 4.0);
    expect_within(found->mount_y_m, kMount.y(), 3.0, 4.0);
    EXPECT_GT(found->mount_x_m.sd, 1.0);
  }
}

TEST(MountEstimate, AMirroredScannerIsSeenAndMirroredBack) {
  std::vector<MotionPair> pairs = motions(80, 0.5, 7);
  for (MotionPair& pair : pairs) {
    pair.laser.y() *= -1.0;
    pair.laser.z() *= -1.0;
  }
  const auto found = estimate_mount(pairs);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_mirrored);
  EXPECT_NEAR(found->mount_x_m.value, kMount.x(), 0.03);
}

TEST(MountEstimate, ScaleAndLagOfTheReference) {
  std::vector<MotionPair> pairs = motions(80, 0.5, 9);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    // It changes its speed and turn by chance, says so 0.2 s late, and 1.25 m for a metre.
    pairs[i].reference_rate =
        Eigen::Vector3d(i % 3 == 0 ? 0.4 : -0.2, 0.0, i % 5 == 0 ? 0.3 : -0.1);
    pairs[i].reference -= 0.2 * pairs[i].reference_rate;
    pairs[i].reference.head<2>() *= 1.25;
    pairs[i].reference_rate.head<2>() *= 1.25;
  }
  const auto found = estimate_mount(pairs);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->way_scale.value, 0.8, 0.01);
  EXPECT_NEAR(found->reference_lag_s.value, 0.2, 0.02);
}

TEST(MountEstimate, AFewMotionsSayNothing) { EXPECT_FALSE(estimate_mount(motions(19, 0.5, 1))); }

}  // namespace
}  // namespace orchard::pose
