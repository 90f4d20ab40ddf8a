// SPDX-License-Identifier: BSD-3-Clause
// Truth: a straight path that is known, and a receiver with white noise, an error that wanders in a
// minute, and two reflections of constant displacement.
#include "pose/filter/fix_hypotheses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pose/graph/georeference.hpp"

namespace orchard::pose {
namespace {

constexpr double kPeriod_s = 0.2;
constexpr double kClaimed_m = 1.8, kNoise_m = 0.5, kWander_m = 1.7, kWander_s = 60.0;

Eigen::Vector2d reflection_at(double time_s) {
  if (time_s > 100.0 && time_s < 107.0) return {4.0, -3.0};
  if (time_s > 199.0 && time_s < 206.0) return {-12.0, 5.0};  // from the end of a gap on
  return Eigen::Vector2d::Zero();
}

SlamGraph graph_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SlamGraph graph;
  graph.georeferenced = true;
  Eigen::Vector2d wander(kWander_m * normal(random), kWander_m * normal(random));
  const double kept = std::exp(-kPeriod_s / kWander_s);
  for (int i = 0; i < 1500; ++i) {
    const double time_s = i * kPeriod_s;
    for (double& axis : wander) {
      axis = kept * axis + kWander_m * std::sqrt(1.0 - kept * kept) * normal(random);
    }
    Keyframe keyframe;
    keyframe.utime = static_cast<std::int64_t>(1e6 * time_s);
    keyframe.T_map_base = {2.0 * time_s, 0.0, 0.0};
    graph.keyframes.push_back(keyframe);
    if (time_s > 160.0 && time_s < 200.0) continue;
    AbsolutePosition fix;
    fix.utime = keyframe.utime;
    fix.is_gnss = true;
    fix.covariance = kClaimed_m * kClaimed_m * Eigen::Matrix2d::Identity();
    fix.p_map = keyframe.T_map_base.head<2>() + wander + reflection_at(time_s);
    fix.p_map += kNoise_m * Eigen::Vector2d(normal(random), normal(random));
    add_position(fix, graph);
  }
  return graph;
}

TEST(DisplacedFixes, ReflectedFixesAreMarkedAndNoOthers) {
  int missed = 0, wrong = 0, num = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SlamGraph graph = graph_of(seed);
    mark_displaced_fixes(graph);
    for (const Keyframe& k : graph.keyframes) {
      for (const AbsolutePosition& fix : k.positions) {
        const bool is_reflected = reflection_at(1e-6 * static_cast<double>(fix.utime)).norm() > 0.0;
        num += is_reflected ? 1 : 0;
        missed += is_reflected && !fix.is_displaced ? 1 : 0;
        wrong += !is_reflected && fix.is_displaced ? 1 : 0;
      }
    }
  }
  EXPECT_LT(missed, num / 50);
  EXPECT_LT(wrong, num / 50);
}

TEST(DisplacedFixes, AGraphWithoutGeoreferenceIsLeftAlone) {
  SlamGraph graph = graph_of(1);
  graph.georeferenced = false;
  mark_displaced_fixes(graph);
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& fix : k.positions) EXPECT_FALSE(fix.is_displaced);
  }
}

}  // namespace
}  // namespace orchard::pose
