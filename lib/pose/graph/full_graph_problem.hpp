// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pose/graph/calibration.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/levenberg_marquardt.hpp"
#include "pose/graph/normal_equations.hpp"
#include "pose/graph/selected_inverse.hpp"
#include "pose/slam_config.hpp"

namespace ceres {
class CostFunction;
}

namespace orchard::pose {

/// Nonlinear least-squares problem of a whole graph, with little memory for long drives:
/// observations are evaluated in place without copies, and landmarks are eliminated one by one
/// while the equations are summed, if that gives fewer coefficients than keeping them.
///
/// Uses Levenberg-Marquardt with the rules of Ceres (trust region, tolerances and losses), so that
/// results agree with Ceres up to rounding. Works on a copy of the unknowns: only write_to()
/// changes a graph. The graph must outlive this object.
class FullGraphProblem {
 public:
  FullGraphProblem(const SlamGraph& graph, const SlamConfig& config);
  ~FullGraphProblem();

  /// Number of multiplications that the factorisation of each iteration takes.
  double factor_work() { return equations_->factor_work(); }

  /// Solves the problem; returns false if it failed. `robust`: all factors but odometry and
  /// calibration get a robust loss (Cauchy).
  bool solve(bool robust, int iterations_max, double tolerance);

  /// Writes the solution, with yaws in (-pi, pi]. Returns false, with nothing written, if a pose is
  /// not finite.
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

  /// First row in covariances() of a pose (negative if it is fixed), a calibration or a receiver's
  /// error.
  int pose_row(int keyframe) const;
  int calibration_row(int index) const;
  int receiver_row(int index) const;  ///< negative if no fix has this error

 private:
  struct Factor {
    std::unique_ptr<ceres::CostFunction> residual;
    bool is_robust = false;
    std::array<int, 3> blocks{};  ///< parameter blocks; only the residual's number is used
  };
  struct LinearisedObservation;
  /// An observation of a landmark that was observed by at least two keyframes.
  struct LandmarkObservation {
    int keyframe = 0;
    const SlamObservation* observation = nullptr;
  };

  void add_factors(const SlamConfig& config);
  void add(ceres::CostFunction* residual, bool is_robust, std::array<int, 3> blocks);
  void add_positions(int keyframe);
  void add_receiver_errors();
  void sort_observations();
  void choose_structure();
  bool try_eliminating(NormalEquations& without, std::size_t num_with) const;

  int num_keyframes() const { return static_cast<int>(graph_.keyframes.size()); }
  int num_landmarks() const { return static_cast<int>(graph_.landmarks.size()); }
  int calibration_block(int index) const { return num_keyframes() + index; }
  int receiver_block(int index) const {
    return calibration_block(static_cast<int>(graph_.calibrations.size())) + index;
  }
  int landmark_block(int landmark) const {
    return receiver_block(static_cast<int>(graph_.receiver_errors.size())) + landmark;
  }
  static constexpr int kHasNoColumn = -1;
  /// Index of a block's first number in a vector of values.
  int value(int block) const;
  bool is_constrained(int landmark) const;

  double cost(const Eigen::VectorXd& values, bool robust) const;
  void linearise(const Eigen::VectorXd& values, bool robust, double damping);
  void add_factor(const Factor& factor, const Eigen::VectorXd& values, bool robust);
  void add_landmark(int landmark, const Eigen::VectorXd& values, bool robust, double damping);
  const std::vector<LinearisedObservation>& linearised_observations(int landmark,
                                                                    const Eigen::VectorXd& values,
                                                                    bool robust);
  /// Adds `sign` times a landmark's position to a difference of positions, given as its derivative
  /// by the equations' unknowns and the covariance of what they do not determine.
  void add_position(int landmark, double sign,
                    Eigen::Matrix<double, Eigen::Dynamic, 2>& by_unknowns, Eigen::Matrix2d& own);
  std::optional<LeastSquaresStep> find_step(const Eigen::VectorXd& values, bool robust,
                                            double damping);
  double norm(const Eigen::VectorXd& values) const;

  const SlamGraph& graph_;
  std::vector<Factor> factors_;                    ///< all factors but observations
  std::vector<LandmarkObservation> observations_;  ///< sorted by landmark
  std::vector<std::size_t> first_observation_;
  std::vector<int> columns_;  ///< per block: its block in the equations; negative: none
  bool eliminates_ = false;   ///< landmarks are eliminated, not unknowns of the equations
  std::unique_ptr<NormalEquations> equations_;
  Eigen::VectorXd gradient_;  ///< of the equations' unknowns, before elimination of landmarks
  Eigen::VectorXd diagonal_;  ///< of H, before elimination of landmarks
  Eigen::VectorXd right_;     ///< gradient after elimination of landmarks
  std::vector<LinearisedObservation> linearised_;
  Eigen::VectorXd values_;
};

}  // namespace orchard::pose
