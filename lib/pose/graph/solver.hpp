// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "pose/graph/calibration.hpp"
#include "pose/graph/graph.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Covariances of the newest keyframe after the solve of a window.
struct WindowSolution {
  bool solved = false;                                         ///< false: the graph is unchanged
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();  ///< relative to the map around it
  /// Joint covariance in map with the calibration: that of the window's first keyframe, propagated
  /// by the window's own measurements, as for a drive through unmapped ground.
  std::optional<JointCovariance> in_map;
};

/// Fixed-lag smoothing: solves for the keyframes from `first` on and the landmarks they observed,
/// with older keyframes fixed. The observations of older keyframes become one prior on the position
/// of each landmark.
WindowSolution solve_window(SlamGraph& graph, int first, const CalibrationPrior& prior,
                            const SlamConfig& config);

/// What the solve of a graph may cost. Both are predicted from the graph.
struct SolveLimits {
  std::size_t num_entries = std::numeric_limits<std::size_t>::max();  ///< of the matrix: its memory
  /// Multiplications of one factorisation of the matrix: the time of an iteration.
  double factor_work = std::numeric_limits<double>::infinity();
};

struct GraphSolution {
  bool solved = false;            ///< false: poses, landmarks and calibrations are unchanged
  bool is_beyond_limits = false;  ///< not tried
  /// Covariance of the newest odometry calibration; none if the information is singular.
  std::optional<Eigen::Matrix3d> calibration_covariance;
};

/// Solves for all poses, landmarks and calibrations; also writes the covariances of the poses, the
/// receiver model, the learnt calibration_walk_sd and observation_noise. `after_closure`: solves
/// first without the robust loss, which would treat the new closure as an outlier.
GraphSolution solve_graph(SlamGraph& graph, bool after_closure, const SlamConfig& config,
                          const SolveLimits& limits = {});

/// Returns the covariance in map of each pair's second position minus its first [m2], by all
/// measurements of a solved graph; none if the information is singular. All landmarks of the pairs
/// must have been observed.
std::optional<std::vector<Eigen::Matrix2d>> relative_covariances(
    const SlamGraph& graph, const std::vector<std::pair<int, int>>& pairs,
    const SlamConfig& config);

}  // namespace orchard::pose
