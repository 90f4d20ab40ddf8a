// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// Longest shift searched for [m].
inline constexpr double kClosureSearchMax_m = 15.0;

/// A landmark as loop closure sees it.
struct ClosureLandmark {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double width_m = 0.0;
  double width_sd_m = 0.1;
};

/// What was mapped on the last stretch of path, and what was mapped long before around there.
struct ClosureQuery {
  std::vector<ClosureLandmark> recent;
  std::vector<ClosureLandmark> old;
  std::vector<Eigen::Vector2d> path;  ///< of the last stretch, in map
  double view_m = 0.0;                ///< what stands nearer than this to the path was in view
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();           ///< the robot, in map
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of its pose against the old
};

/// The answer: the recent landmarks, turned about the pivot and shifted, are old ones.
struct Closure {
  bool found = false;
  bool ambiguous = false;                           ///< another shift explains them as well
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< x, y [m], yaw [rad]
  std::vector<std::pair<int, int>> matches;         ///< (recent, old) landmarks
  double log_odds = 0.0;  ///< against trees of another row that stands as regularly
  std::int64_t num_operations = 0;
};

/// Looks for the one shift and turn, within what the pose's covariance allows, that lays the
/// constellation of recent landmarks onto old ones. Every tree that fits counts for it as much as
/// its residual is smaller than the irregularity of a planted row; every gap that one side knows
/// and the other does not counts against it. Not found unless closure_min_trees fit, and the odds
/// beat both another place as regular and every other shift (the next tree, the next row) by
/// closure_margin.
Closure find_closure(const ClosureQuery& query, const SlamConfig& config);

}  // namespace orchard::pose
