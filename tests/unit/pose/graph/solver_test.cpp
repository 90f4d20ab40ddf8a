// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/solver.hpp"
#include "geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

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

/// Twelve keyframes on a curve past nine trunks, with noisy measurements and one gross error.
SlamGraph curve_past_trunks(std::uint64_t seed) {
  simulation::Random random(seed);
  SlamGraph graph;
  graph.calibrations.emplace_back(OdometryCalibration::Zero());
  std::vector<Eigen::Vector2d> trunks;
  for (int l = 0; l < 9; ++l) trunks.emplace_back(1.5 * l - 2.0, l % 2 == 0 ? 2.0 : -1.5);
  graph.landmarks.resize(trunks.size());
  for (std::size_t l = 0; l < trunks.size(); ++l) {
    graph.landmarks[l].p_map = trunks[l] + 0.05 * Eigen::Vector2d(random.normal(), random.normal());
  }
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  const Eigen::Vector3d step(0.8, 0.0, 0.1);
  for (int k = 0; k < 12; ++k) {
    Keyframe keyframe;
    keyframe.T_map_base = T;
    if (k > 0) {
      keyframe.motion.delta =
          step + 0.01 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      keyframe.motion.covariance = 1e-4 * Eigen::Matrix3d::Identity();
      keyframe.motion.calibration_jacobian = step.asDiagonal();
      keyframe.T_map_base += 0.02 * Eigen::Vector3d(random.normal(), random.normal(), 0.0);
    }
    graph.keyframes.push_back(keyframe);
    for (int l = 0; l < 9; ++l) {
      Eigen::Vector2d p_base = geometry::inverse_transform(T, trunks[l]);
      if (p_base.norm() > 5.0) continue;
      p_base += 0.02 * Eigen::Vector2d(random.normal(), random.normal());
      if (k == 5 && l == 3) p_base.x() += 0.5;
      graph.add_observation(k, l, p_base, 4e-4 * Eigen::Matrix2d::Identity(), 0.0);
    }
    T = geometry::compose(T, step);
  }
  return graph;
}

TEST(SlamSolver, AWindowOfTheWholeGraphIsTheWholeGraph) {
  const SlamConfig config;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    // The first keyframe is the origin of both; only the window leaves out its observations.
    SlamGraph window = curve_past_trunks(seed);
    for (const SlamObservation& o : window.keyframes[0].observations) {
      std::vector<int>& seen_by = window.landmarks[o.landmark].keyframes;
      seen_by.erase(seen_by.begin());
    }
    window.keyframes[0].observations.edit().clear();
    SlamGraph whole = window;
    const WindowSolution solution =
        solve_window(window, 1, CalibrationPrior::initial(config), config);
    ASSERT_TRUE(solve_graph(whole, false, config).solved);
    // A window ends when an iteration gains 1e-4 of a cost of about 50: a tenth of a sigma of 2 cm.
    EXPECT_LT((window.calibrations[0] - whole.calibrations[0]).norm(), 2e-3);
    for (std::size_t k = 0; k < whole.keyframes.size(); ++k) {
      const Eigen::Vector3d& a = window.keyframes[k].T_map_base;
      EXPECT_LT((a - whole.keyframes[k].T_map_base).norm(), 2e-3) << "keyframe " << k;
    }
    for (std::size_t l = 0; l < whole.landmarks.size(); ++l) {
      const Eigen::Vector2d& a = window.landmarks[l].p_map;
      EXPECT_LT((a - whole.landmarks[l].p_map).norm(), 2e-3) << "landmark " << l;
    }
    const Eigen::Matrix3d& P = whole.keyframes.back().covariance;
    EXPECT_LT((solution.local_covariance - P).norm(), 0.01 * P.norm());
  }
}

TEST(SlamSolver, AGraphBeyondItsLimitsIsLeftAsItWas) {
  const SlamConfig config;
  const SlamGraph before = curve_past_trunks(1);
  std::size_t num_observations = 0;
  for (const Keyframe& k : before.keyframes) num_observations += k.observations.size();
  SolveLimits little_memory, little_time, enough;
  little_memory.num_entries = 6 * num_observations - 1;
  little_time.factor_work = 100.0;  // less than that of three dense poses
  enough.num_entries = 6 * num_observations;
  enough.factor_work = 38 * 38 * 38 / 3.0;  // a dense matrix of 12 poses and a calibration
  for (const SolveLimits& limits : {little_memory, little_time}) {
    SlamGraph graph = before;
    const GraphSolution solution = solve_graph(graph, false, config, limits);
    EXPECT_TRUE(solution.is_beyond_limits);
    EXPECT_FALSE(solution.solved);
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      EXPECT_EQ(graph.keyframes[k].T_map_base, before.keyframes[k].T_map_base) << "keyframe " << k;
    }
  }
  SlamGraph graph = before;
  const GraphSolution solution = solve_graph(graph, false, config, enough);
  EXPECT_FALSE(solution.is_beyond_limits);
  EXPECT_TRUE(solution.solved);
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
