// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "pose/graph/calibration.hpp"
#include "pose/graph/factors.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/levenberg_marquardt.hpp"

namespace orchard::pose {

/// Nonlinear least-squares problem of the last keyframes of a graph. Landmarks are eliminated one
/// by one while the equations are summed; those of the few poses are dense.
///
/// Observations, absolute positions and priors on landmarks have a robust loss (Cauchy). Works on a
/// copy of the unknowns: only write_to() changes a graph. The graph must outlive this object.
class WindowProblem {
 public:
  /// `first`: the first keyframe of the window; the poses of earlier ones are fixed.
  WindowProblem(const SlamGraph& graph, int first);
  ~WindowProblem();

  /// `is_own`: the factor counts as a measurement of this problem, not as a prior from outside it;
  /// see information().
  void add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own);
  void add_relative_pose(const RelativePose& relative, bool is_own);
  void add_observation(int keyframe, const SlamObservation& observation);
  /// Adds the absolute positions of a keyframe; does nothing while the graph is not georeferenced.
  void add_positions(int keyframe);
  /// Adds the factors between successive receiver errors of all positions that were added; call it
  /// once, after them.
  void add_receiver_errors();
  /// Adds a prior on a landmark that add_observation() has named.
  void add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                          const Eigen::Matrix2d& covariance);
  void add_calibration_prior(int index, const CalibrationPrior& prior);
  /// Adds the random walk from the calibration before `index`, with the decay factors `kept`.
  void add_calibration_walk(int index, const Eigen::Vector3d& kept);

  /// Solves the problem; returns false if it failed.
  bool solve(int iterations_max, double tolerance);

  /// Returns the information of poses, calibrations and receiver errors at the present values, with
  /// the landmarks marginalised: by all factors, or by the problem's own measurements alone.
  enum class Evidence { kAll, kOwnMeasurements };
  Eigen::MatrixXd information(Evidence evidence);

  /// First row in information() of a pose of the window, or of a calibration.
  int pose_row(int keyframe) const;
  int calibration_row(int index) const;

  /// Writes the solution, with yaws in (-pi, pi]. Returns false, with nothing written, if a pose is
  /// not finite.
  bool write_to(SlamGraph& graph) const;

 private:
  static constexpr int kFixed = -1;

  /// Some of the values: a pose, a calibration or a receiver's error.
  struct Block {
    int size = 0;
    int value = 0;     ///< index of its first number in the values
    int row = kFixed;  ///< of its first number in the equations
    bool is_pose = false;
  };
  struct Factor;
  struct Observation;
  struct LinearisedObservation;
  struct Landmark;

  /// Each returns the index of a block, new with its value in the graph at the first call.
  int pose(int keyframe);
  int calibration(int index);
  int receiver_error(int index);
  int add_block(const Eigen::VectorXd& value, bool is_fixed, bool is_pose);
  void add(ceres::CostFunction* residual, bool is_robust, bool is_own, std::vector<int> blocks);

  void place(const Eigen::VectorXd& values);
  double cost(const Eigen::VectorXd& values);
  void linearise(const Eigen::VectorXd& values, double damping, Evidence evidence);
  void add_factor(const Factor& factor, const Eigen::VectorXd& values);
  void add_landmark(Landmark& landmark, const Eigen::VectorXd& values, double damping,
                    Evidence evidence);
  void add_prior(Landmark& landmark, const Eigen::Vector2d& p_map);
  std::optional<LeastSquaresStep> find_step(const Eigen::VectorXd& values, double damping);
  double norm(const Eigen::VectorXd& values) const;

  const SlamGraph& graph_;
  int first_;
  std::vector<Block> blocks_;
  std::map<int, int> poses_;  ///< block of each keyframe
  std::map<int, int> calibrations_;
  std::map<int, int> receiver_errors_;
  std::vector<Factor> factors_;             ///< all factors but observations
  std::map<int, std::size_t> landmark_at_;  ///< index in landmarks_
  std::vector<Landmark> landmarks_;
  std::vector<double> start_;  ///< values while the problem is built
  Eigen::VectorXd values_;
  int num_rows_ = 0;

  std::vector<BasePlacement> placed_;  ///< per block that is a pose
  Eigen::MatrixXd H_;                  ///< lower triangle, after elimination of landmarks
  Eigen::VectorXd gradient_;           ///< before elimination of landmarks
  Eigen::VectorXd diagonal_;           ///< of H, before elimination of landmarks
  Eigen::VectorXd right_;              ///< gradient after elimination of landmarks
};

}  // namespace orchard::pose
