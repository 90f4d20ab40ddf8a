// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

constexpr double kRing_m = 10.0;

constexpr int kTrunks = 600;

/// A drive of that many metres, a keyframe each, round and round inside a ring of trunks of which
/// each keyframe sees twelve: every place is tied to every other. The poses drift by half a metre.
SlamMap rounds_inside_a_ring(int num_keyframes) {
  SlamMap map{SlamConfig{}};
  SlamGraph& graph = map.graph;
  std::vector<Eigen::Vector2d> trunks;
  for (int l = 0; l < kTrunks; ++l) {
    const double at_rad = 2.0 * M_PI * l / kTrunks;
    // The origin lies on the path, which leaves it along x.
    trunks.emplace_back(1.4 * kRing_m * std::sin(at_rad),
                        kRing_m - 1.4 * kRing_m * std::cos(at_rad));
    SlamLandmark landmark;
    landmark.p_map = trunks.back();
    landmark.confirmed = true;
    landmark.add_width(0.1, 0.01);
    graph.landmarks.push_back(landmark);
  }
  const Eigen::Vector3d step(kRing_m * std::sin(1.0 / kRing_m),
                             kRing_m * (1.0 - std::cos(1.0 / kRing_m)), 1.0 / kRing_m);
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  for (int k = 0; k < num_keyframes; ++k) {
    Keyframe keyframe;
    keyframe.utime = 100'000 * k;
    keyframe.travel_m = k;
    keyframe.T_map_base = T;
    if (k > 0) {
      keyframe.motion.delta = step;
      keyframe.motion.covariance = 1e-4 * Eigen::Matrix3d::Identity();
      keyframe.motion.travel_m = 1.0;
      keyframe.T_map_base.x() += 0.5 * k / num_keyframes;
    }
    graph.keyframes.push_back(keyframe);
    for (int i = 0; i < 12; ++i) {
      const int l = (31 * k + 53 * i) % kTrunks;
      graph.add_observation(k, l, geometry::inverse_transform(T, trunks[l]),
                            1e-4 * Eigen::Matrix2d::Identity(), 0.01);
    }
    T = geometry::compose(T, step);
  }
  return map;
}

double farthest_from_ring_m(const SlamMap& map) {
  double farthest_m = 0.0;
  for (const Keyframe& k : map.graph.keyframes) {
    const double radius_m = (k.T_map_base.head<2>() - Eigen::Vector2d(0.0, kRing_m)).norm();
    farthest_m = std::max(farthest_m, std::abs(radius_m - kRing_m));
  }
  return farthest_m;
}

TEST(SlamMap, SubmapsGrowWhereReturningFillsTheFactor) {
  // The dense factor of three unknowns per submap of nine keyframes takes (n / 3)^3 / 3
  // multiplications for n keyframes, and 5.7e4 n are allowed: as many for n = 2150.
  SlamMap few = rounds_inside_a_ring(900);
  ASSERT_TRUE(few.solve(SolveReason::kGrowth));
  EXPECT_EQ(few.submap_length_m(), SlamConfig{}.submap_length_m);
  EXPECT_LT(farthest_from_ring_m(few), 0.05);
  SlamMap many = rounds_inside_a_ring(2700);
  ASSERT_TRUE(many.solve(SolveReason::kGrowth));
  EXPECT_EQ(many.submap_length_m(), 2.0 * SlamConfig{}.submap_length_m);
  EXPECT_LT(farthest_from_ring_m(many), 0.05);
}

}  // namespace
}  // namespace orchard::pose
