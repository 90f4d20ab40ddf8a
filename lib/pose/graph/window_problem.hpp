// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <set>

#include "pose/graph/dense_equations.hpp"
#include "pose/graph/graph_problem.hpp"

namespace orchard::pose {

/// Problem of the last keyframes of a graph; the equations of the few poses are dense.
/// Observations, absolute positions and priors on landmarks have a robust loss (Cauchy).
class WindowProblem : public GraphProblem<DenseEquations> {
 public:
  /// `first`: the first keyframe of the window; the poses of earlier ones are fixed.
  WindowProblem(const SlamGraph& graph, int first) : GraphProblem(graph, first, true) {}

  /// Adds the observations of these landmarks from the first to the newest keyframe; call it once.
  void add_observations(int first, int newest, const std::set<int>& landmarks);
  /// Adds a prior on a landmark that was observed.
  void add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                          const Eigen::Matrix2d& covariance);

  /// Solves the problem, to which nothing may be added afterwards; returns false if it failed.
  bool solve(int iterations_max, double tolerance);

  using GraphProblem::Evidence;
  /// Returns the information of poses, calibrations and receiver errors at the present values, with
  /// the landmarks marginalised: by all factors, or by the problem's own measurements alone.
  Eigen::MatrixXd information(Evidence evidence);
};

}  // namespace orchard::pose
