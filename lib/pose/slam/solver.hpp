// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pose/slam/graph.hpp"
#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// Travel over which the odometry calibration is taken as constant [m].
inline constexpr double kCalibrationTravel_m = 10.0;

/// The odometry calibration as known without the observations that are about to be used.
struct CalibrationPrior {
  OdometryCalibration mean = OdometryCalibration::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();

  /// Standard deviations before anything is estimated.
  static Eigen::Vector3d initial_sd(const SlamConfig& config);
  static CalibrationPrior initial(const SlamConfig& config);
  /// Of its change from one interval of travel to the next.
  static Eigen::Vector3d walk_sd(const SlamConfig& config);

  /// What is known of it so many intervals later; never less than at the start.
  CalibrationPrior after(int num_intervals, const SlamConfig& config) const;
};

/// Covariances of the newest keyframe by a solved window.
struct WindowSolution {
  bool solved = false;                                         ///< else the graph is as it was
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();  ///< against the map around it
  /// Against the window's first keyframe and in its frame, by the window's own measurements: the
  /// uncertainty that a drive through unknown ground adds.
  Eigen::Matrix3d drift_covariance = Eigen::Matrix3d::Zero();
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

/// Solves for all poses, landmarks and calibrations, and writes the poses' covariances.
/// `after_closure`: first without the robust loss, which would keep a newly closed loop open.
GraphSolution solve_graph(SlamGraph& graph, bool after_closure, const SlamConfig& config);

}  // namespace orchard::pose
