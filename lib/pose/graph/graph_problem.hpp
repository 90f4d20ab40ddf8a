// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>
#include <ceres/types.h>

#include <Eigen/Core>
#include <map>
#include <set>
#include <vector>

#include "pose/graph/calibration.hpp"
#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Working copy of the unknowns of a solve. Only write_to() changes a graph, so a failed solve
/// leaves it unchanged.
class Unknowns {
 public:
  explicit Unknowns(const SlamGraph& graph) : graph_(graph) {}

  Eigen::Vector3d& pose(int keyframe);
  Eigen::Vector2d& position(int landmark);
  OdometryCalibration& calibration(int index);
  Eigen::Vector2d& receiver_error(int index);

  /// Wraps yaws to (-pi, pi].
  void wrap_yaws();
  bool poses_are_finite() const;
  void write_to(SlamGraph& graph) const;

 private:
  const SlamGraph& graph_;
  std::map<int, Eigen::Vector3d> poses_;
  std::map<int, Eigen::Vector2d> positions_;
  std::map<int, OdometryCalibration> calibrations_;
  std::map<int, Eigen::Vector2d> receiver_errors_;
};

/// Nonlinear least-squares problem over a working copy. Parameter blocks are in the order in which
/// factors are added.
class GraphProblem {
 public:
  /// `robust`: observations and absolute positions get a robust loss (Cauchy).
  GraphProblem(const SlamGraph& graph, Unknowns& unknowns, bool robust);

  /// `is_own`: the factor counts as a measurement of this problem, not as a prior from outside it;
  /// see measured_rows().
  void add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own);
  void add_relative_pose(const RelativePose& relative, bool is_own);
  void add_observation(int keyframe, const SlamObservation& observation);
  /// Adds the absolute positions of a keyframe; does nothing while the graph is not georeferenced.
  void add_positions(int keyframe);
  /// Adds the factors between successive receiver errors of all positions that were added.
  void add_receiver_errors();
  void add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                          const Eigen::Matrix2d& covariance);
  void add_calibration_prior(int index, const CalibrationPrior& prior);
  /// Adds the random walk from the calibration before `index`, with the decay factors `kept`.
  void add_calibration_walk(int index, const Eigen::Vector3d& kept);
  void fix_pose(int keyframe);

  bool solve(ceres::LinearSolverType type, int iterations_max, double tolerance);

  /// Returns the Jacobian of the residuals, with columns in the order of `blocks`.
  ceres::CRSMatrix jacobian(const std::vector<double*>& blocks);

  /// Returns per row of jacobian() whether it belongs to the problem's own measurements, not to a
  /// prior.
  std::vector<char> measured_rows() const;

  double* pose(int keyframe) { return unknowns_.pose(keyframe).data(); }
  double* position(int landmark) { return unknowns_.position(landmark).data(); }
  double* calibration(int index) { return unknowns_.calibration(index).data(); }
  /// Returns the receiver errors in order of time.
  std::vector<double*> receiver_errors();

 private:
  ceres::LossFunction* loss() const;

  const SlamGraph& graph_;
  Unknowns& unknowns_;
  bool robust_;
  ceres::Problem problem_;
  std::set<int> receiver_errors_;                     ///< of the positions that were added
  std::vector<ceres::ResidualBlockId> measurements_;  ///< the problem's own
};

}  // namespace orchard::pose
