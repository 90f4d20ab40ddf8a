// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/slam/graph.hpp"
#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// What is known of the wheels' errors without the sightings that are about to be used.
struct ErrorsPrior {
  WheelErrors mean = WheelErrors::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// Covariances that a solved window leaves.
struct WindowSolution {
  bool solved = false;                                         ///< else the graph is as it was
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();  ///< newest against the map around it
  /// Newest against the window's first keyframe, by the window's own sightings, in the frame of
  /// that first one: what a drive into the unknown adds.
  Eigen::Matrix3d drift_covariance = Eigen::Matrix3d::Zero();
};

/// Corrects the keyframes from `first` on and what they saw, all older keyframes held. What the
/// older ones saw of the same landmarks enters as one place per landmark.
WindowSolution solve_window(SlamGraph& graph, int first, const ErrorsPrior& errors,
                            const SlamConfig& config);

/// How the whole graph is solved.
struct WholeSolve {
  bool closing = false;     ///< first without the robust loss: a loop has just been closed
  bool covariances = true;  ///< writes those of all keyframes
};

/// Corrects everything together. False, and the graph as it was, if the solver found no solution.
bool solve_whole(SlamGraph& graph, const ErrorsPrior& errors, const WholeSolve& options,
                 const SlamConfig& config, Eigen::Matrix3d* newest_errors_covariance);

/// Standard deviation of the wheels' errors before anything is learnt.
Eigen::Vector3d initial_errors_sd(const SlamConfig& config);

}  // namespace orchard::pose
