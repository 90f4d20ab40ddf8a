// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pose/graph/calibration.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/joint_covariance.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Covariances of the newest keyframe by a solved window.
struct WindowSolution {
  bool solved = false;                                         ///< else the graph is as it was
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();  ///< against the map around it
  /// In map, with the calibration: from what was known at the window's first keyframe, by the
  /// window's own measurements. What a drive through unknown ground comes to.
  std::optional<JointCovariance> in_map;
};

/// Fixed-lag smoothing: solves for the keyframes from `first` on and the landmarks that they
/// observed, older keyframes fixed. The observations of older keyframes become one prior on each
/// landmark's position.
WindowSolution solve_window(SlamGraph& graph, int first, const CalibrationPrior& prior,
                            const SlamConfig& config);

struct GraphSolution {
  bool solved = false;  ///< else the graph is as it was
  /// Of the newest odometry calibration; none where the information is singular.
  std::optional<Eigen::Matrix3d> calibration_covariance;
};

/// Solves for all poses, landmarks and calibrations; writes the poses' covariances, and how much
/// the calibration changes on this drive. `after_closure`: first without the robust loss, which
/// would keep a newly closed loop open.
GraphSolution solve_graph(SlamGraph& graph, bool after_closure, const SlamConfig& config);

}  // namespace orchard::pose
