// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/solver.hpp"
#include "geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

/// A path of four keyframes of which the last two see one trunk, with poses that are off. Nothing
/// measures the motion between them: `motion_sd` is its standard deviation.
SlamGraph one_trunk_in_the_dark(std::uint64_t seed, double motion_sd) {
  simulation::Random random(seed);
  SlamGraph graph;
  graph.calibrations.emplace_back(OdometryCalibration::Zero());
  graph.landmarks.resize(1);
  graph.landmarks[0].p_map = {3.0 + random.uniform(), 2.0 + random.uniform()};
  for (int k = 0; k < 4; ++k) {
    Keyframe keyframe;
    keyframe.T_map_base = {k + 0.3 * random.uniform(), 0.3 * random.uniform(), random.uniform()};
    keyframe.motion.delta = {1.0, 0.0, 0.0};
    keyframe.motion.covariance = motion_sd * motion_sd * Eigen::Matrix3d::Identity();
    graph.keyframes.push_back(keyframe);
    if (k < 2) continue;
    const Eigen::Vector2d p_base(2.0 + random.uniform(), random.uniform());
    graph.add_observation(k, 0, p_base, 1e-8 * Eigen::Matrix2d::Identity(), 0.0);
  }
  return graph;
}

TEST(SlamSolver, AWindowThatIsNotSolvedLeavesTheGraphAsItWas) {
  // One trunk tells two of three numbers of a pose: with motions that say nothing, whether the
  // information can be inverted at all is a matter of rounding.
  int num_unsolved = 0;
  int num_solved = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SlamGraph before = one_trunk_in_the_dark(seed, seed % 2 == 0 ? 1e9 : 0.1);
    SlamGraph graph = before;
    const WindowSolution solution = solve_window(graph, 1, CalibrationPrior{}, SlamConfig{});
    if (solution.solved) {
      ++num_solved;
      EXPECT_NE(graph.keyframes[3].T_map_base, before.keyframes[3].T_map_base);
      continue;
    }
    ++num_unsolved;
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      EXPECT_EQ(graph.keyframes[k].T_map_base, before.keyframes[k].T_map_base) << "keyframe " << k;
    }
    EXPECT_EQ(graph.landmarks[0].p_map, before.landmarks[0].p_map);
    EXPECT_EQ(graph.calibrations[0], before.calibrations[0]);
  }
  EXPECT_GE(num_unsolved, 5);
  EXPECT_GE(num_solved, 5);
}

}  // namespace
}  // namespace orchard::pose
