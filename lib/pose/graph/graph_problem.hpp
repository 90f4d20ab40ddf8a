// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pose/graph/calibration.hpp"
#include "pose/graph/factors.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/normal_equations.hpp"

namespace orchard::pose {

/// Nonlinear least-squares problem of keyframes of a graph, with what they measured. Landmarks are
/// eliminated one by one while the equations are summed, unless they are unknowns of the equations.
///
/// Uses Levenberg-Marquardt with the rules of Ceres (trust region, tolerances and losses), so that
/// results agree with Ceres up to rounding. Works on a copy of the unknowns: only write_to()
/// changes a graph. The graph must outlive this object.
class GraphProblem {
 public:
  /// Writes the solution, with yaws in (-pi, pi]. Returns false, with nothing written, if a pose is
  /// not finite.
  bool write_to(SlamGraph& graph) const;

  /// First row in the equations of a pose or of a receiver's error, each negative if it is none of
  /// their unknowns, or of a calibration.
  int pose_row(int keyframe) const { return row_of(poses_, keyframe); }
  int calibration_row(int index) const { return row_of(calibrations_, index); }
  int receiver_row(int index) const { return row_of(receiver_errors_, index); }

  /// `is_own`: the factor counts as a measurement of this problem, not as a prior from outside it.
  void add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own);
  void add_relative_pose(const RelativePose& relative, bool is_own);
  /// Adds the absolute positions of a keyframe; does nothing while the graph is not georeferenced.
  void add_positions(int keyframe);
  /// Adds the factors between successive receiver errors of all positions that were added; call it
  /// once, after them.
  void add_receiver_errors();
  void add_calibration_prior(int index, const CalibrationPrior& prior);
  /// Adds the random walk from the calibration before `index`, with the decay factors `kept`.
  void add_calibration_walk(int index, const Eigen::Vector3d& kept);

 protected:
  static constexpr int kNone = -1;  // derived: no index
  enum class Evidence { kAll, kOwnMeasurements };

  /// Some of the values: a pose, a calibration, a receiver's error or a landmark.
  struct Block {
    int size = 0;
    int value = 0;       ///< index of its first number in the values
    int column = kNone;  ///< its block in the equations; none: fixed, or eliminated
    int pose = kNone;    ///< number among the poses
  };
  struct Factor {
    std::unique_ptr<ceres::CostFunction> residual;
    bool is_robust = false;
    bool is_own = false;
    int num_blocks = 0;
    std::array<int, 3> blocks{};
  };
  struct Observation {
    int pose = 0;  ///< block
    const SlamObservation* observation = nullptr;
  };
  struct Landmark {
    int id = 0;
    int block = 0;
    std::size_t first = 0, end = 0;  ///< its observations
    std::unique_ptr<ceres::CostFunction> prior;
  };
  struct LinearisedObservation {
    int column = kNone;  ///< block of its pose in the equations
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, 3> by_pose;
    Eigen::Matrix2d by_position;
  };
  /// Equations of a landmark's position, given the poses.
  struct Position {
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  };
  using Linearised = std::vector<LinearisedObservation>;

  /// `first`: the first keyframe whose pose is unknown. `is_small`: observations are kept as they
  /// are evaluated, for speed; else they are evaluated in place each time, without copies.
  GraphProblem(const SlamGraph& graph, int first, bool is_small);
  ~GraphProblem();

  /// Each returns the index of a block, new with its value in the graph at the first call.
  int pose(int keyframe);
  int calibration(int index);
  int receiver_error(int index);
  /// Returns the index in landmarks_, likewise.
  int landmark(int id);

  /// Adds observations; for_each(visit) calls visit(keyframe, observation) for each, in order of
  /// keyframes and each time the same.
  template <class ForEach>
  void add_observations(const ForEach& for_each);

  /// Completes the structure: no block may be added afterwards.
  void finish();

  /// Makes all blocks but landmarks and fixed poses unknowns of the equations; returns their sizes.
  std::vector<int> set_columns();

  /// Solves the problem; returns false if it failed. `robust`: all factors but odometry and
  /// calibration get a robust loss (Cauchy).
  bool solve(bool robust, int iterations_max, double tolerance);
  void linearise(bool robust, double damping, Evidence evidence = Evidence::kAll);
  void linearise_observations(const Observation* begin, const Observation* end,
                              const Eigen::Vector2d& p_map, bool robust, Linearised& out) const;
  /// Fits placed_ to the values.
  void place(const Eigen::VectorXd& values);
  const Linearised& linearised(std::size_t landmark, bool robust);

  const SlamGraph& graph_;
  std::vector<Block> blocks_;
  std::vector<Factor> factors_;  ///< all factors but observations
  std::vector<Observation> observations_;
  std::vector<Landmark> landmarks_;
  std::vector<int>
      landmark_at_;  ///< per landmark of the graph: index in landmarks_; negative: none
  std::unique_ptr<NormalEquations> equations_;
  Eigen::VectorXd values_;

 private:
  /// Change of all unknowns in one iteration.
  struct Step {
    Eigen::VectorXd change;
    double gain = 0.0;  ///< decrease of the cost predicted by the linear model
  };

  int add_block(const Eigen::VectorXd& value);
  int row_of(const std::map<int, int>& blocks, int index) const;
  void add(ceres::CostFunction* residual, bool is_robust, bool is_own,
           std::initializer_list<int> blocks);
  ObservationResidual residual_of(const Observation& observation) const;
  double cost(const Eigen::VectorXd& values, bool robust);
  void add_factor(const Factor& factor, bool robust);
  void add_landmark(std::size_t landmark, bool robust, double damping, Evidence evidence);
  Position position_of(const Landmark& landmark, const Linearised& observations,
                       Evidence evidence) const;
  std::optional<Step> find_step(bool robust, double damping);
  double norm_of_unknowns() const;

  int first_;
  bool is_small_;
  std::map<int, int> poses_;  ///< block of each keyframe
  std::map<int, int> calibrations_;
  std::map<int, int> receiver_errors_;
  std::vector<double> start_;  ///< values while the problem is built
  int num_poses_ = 0;

  std::vector<BasePlacement> placed_;           ///< per pose
  std::vector<ObservationResidual> residuals_;  ///< of a small problem, per observation
  std::vector<Linearised> kept_;                ///< of a small problem, per landmark
  Linearised scratch_;
  Eigen::VectorXd gradient_;  ///< of the equations' unknowns, before elimination of landmarks
  Eigen::VectorXd diagonal_;  ///< of H, before elimination of landmarks
  Eigen::VectorXd right_;     ///< gradient after elimination of landmarks
};

template <class ForEach>
void GraphProblem::add_observations(const ForEach& for_each) {
  for_each([&](int keyframe, const SlamObservation& o) {
    pose(keyframe);
    ++landmarks_[landmark(o.landmark)].end;
  });
  std::size_t num = 0;
  for (Landmark& l : landmarks_) {
    l.first = num;
    num += l.end;
    l.end = l.first;
  }
  observations_.resize(num);
  for_each([&](int keyframe, const SlamObservation& o) {
    Landmark& l = landmarks_[landmark(o.landmark)];
    observations_[l.end++] = {pose(keyframe), &o};
  });
}

}  // namespace orchard::pose
