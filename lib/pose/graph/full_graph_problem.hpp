// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "pose/graph/graph_problem.hpp"
#include "pose/graph/normal_equations.hpp"
#include "pose/graph/selected_inverse.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Problem of a whole graph, with little memory for long drives: landmarks are eliminated if that
/// gives fewer coefficients than keeping them.
class FullGraphProblem : public GraphProblem<NormalEquations> {
 public:
  FullGraphProblem(const SlamGraph& graph, const SlamConfig& config);

  /// Number of multiplications that the factorisation of each iteration takes.
  double factor_work() { return equations_->factor_work(); }

  /// Solves the problem; returns false if it failed. `robust`: all factors but odometry and
  /// calibration get a robust loss (Cauchy).
  using GraphProblem::solve;

  /// As GraphProblem's, and makes the graph forget its sums of older observations.
  bool write_to(SlamGraph& graph) const;

  /// Returns the covariances at the solution of solve(true); none if the information is singular.
  /// Consumes the equations, so no solve may follow.
  std::optional<SelectedInverse> covariances();

  /// Factorises the equations at the present values, for relative_covariance(); returns false if
  /// the information is singular.
  bool factorise();

  /// Returns the covariance of the position of landmark `b` minus that of `a`, both observed at
  /// least once; call after factorise().
  Eigen::Matrix2d relative_covariance(int a, int b);

 private:
  void add_blocks();
  void add_factors(const SlamConfig& config);
  void choose_structure();
  void couple_factors(NormalEquations& equations) const;
  bool try_eliminating(NormalEquations& without, std::size_t num_with) const;
  /// Adds `sign` times a landmark's position to a difference of positions, given as its derivative
  /// by the equations' unknowns and the covariance of what they do not determine.
  void add_position(int landmark, double sign,
                    Eigen::Matrix<double, Eigen::Dynamic, 2>& by_unknowns, Eigen::Matrix2d& own);
};

}  // namespace orchard::pose
