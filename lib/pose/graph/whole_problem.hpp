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
#include "pose/graph/normal_equations.hpp"
#include "pose/graph/selected_inverse.hpp"
#include "pose/slam_config.hpp"

namespace ceres {
class CostFunction;
}

namespace orchard::pose {

/// A whole graph as nonlinear least squares, for graphs of any length: observations are evaluated
/// where they lie, never copied, and landmarks are eliminated one by one while the equations are
/// summed, where that leaves fewer numbers than their own columns would be.
///
/// Levenberg-Marquardt with the rules of Ceres (its trust region, tolerances and losses), so that
/// both give the same digits but for rounding. Works on a copy of the unknowns: the graph, which
/// must outlive this, changes by write_to() only.
class WholeProblem {
 public:
  WholeProblem(const SlamGraph& graph, const SlamConfig& config);
  ~WholeProblem();

  /// `robust`: observations and absolute positions get a robust loss (Cauchy). False where no
  /// solution was found.
  bool solve(bool robust, int iterations_max, double tolerance);

  /// Yaws in (-pi, pi]. False, and nothing written, where a pose is not finite.
  bool write_to(SlamGraph& graph) const;

  /// Covariances at the solution of solve(true); none where the information is singular. The last
  /// thing to ask for.
  std::optional<SelectedInverse> covariances();

  /// First row in them of a pose, negative for one that is known; of a calibration.
  int pose_row(int keyframe) const;
  int calibration_row(int index) const;

 private:
  struct Factor {
    std::unique_ptr<ceres::CostFunction> residual;
    bool is_robust = false;
    std::array<int, 3> blocks{};  ///< as many as the residual has parameters
  };
  struct Sight;
  struct Step;
  /// An observation of a landmark that at least one other keyframe observed, too.
  struct Seen {
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
  /// Where a block begins among the values.
  int value(int block) const;
  bool is_constrained(int landmark) const;

  double cost(const Eigen::VectorXd& values, bool robust) const;
  void linearise(const Eigen::VectorXd& values, bool robust, double damping);
  void add_factor(const Factor& factor, const Eigen::VectorXd& values, bool robust);
  void add_landmark(int landmark, const Eigen::VectorXd& values, bool robust, double damping);
  const std::vector<Sight>& sights_of(int landmark, const Eigen::VectorXd& values, bool robust);
  std::optional<Step> find_step(const Eigen::VectorXd& values, bool robust, double damping);
  double norm(const Eigen::VectorXd& values) const;

  const SlamGraph& graph_;
  std::vector<Factor> factors_;  ///< all but observations
  std::vector<Seen> seen_;       ///< landmark by landmark
  std::vector<std::size_t> first_seen_;
  std::vector<int> columns_;  ///< of each block among the equations'; negative: has none
  bool eliminates_ = false;   ///< landmarks are no unknowns of the equations
  std::unique_ptr<NormalEquations> equations_;
  Eigen::VectorXd gradient_;  ///< by the equations' unknowns, before landmarks were eliminated
  Eigen::VectorXd diagonal_;  ///< of H, likewise
  Eigen::VectorXd right_;     ///< the gradient after
  std::vector<Sight> sights_;
  Eigen::VectorXd values_;
};

}  // namespace orchard::pose
