// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Two trees fix a motion: a third can contradict it.
inline constexpr std::size_t kClosureTreesMin = 3;

/// A landmark for loop closure.
struct ClosureLandmark {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double width_m = 0.0;
  double width_sd_m = 0.1;
  double seen_m = 0.0;  ///< farthest that it was observed from
};

/// Landmarks mapped on the last part of the path, and those mapped long before near there.
struct ClosureQuery {
  std::vector<ClosureLandmark> recent;
  std::vector<ClosureLandmark> old;
  std::vector<Eigen::Vector2d> path;                ///< its last part, in map
  std::vector<Eigen::Vector2d> old_path;            ///< places that old landmarks were seen from
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< the robot, in map
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of its pose against the old
};

/// The rigid motion about the pivot that registers recent landmarks to old ones.
struct Closure {
  bool found = false;
  bool ambiguous = false;                           ///< another motion explains them as well
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< x, y [m], yaw [rad]
  std::vector<std::pair<int, int>> matches;         ///< (recent, old) landmarks
  double log_odds = 0.0;  ///< against the null hypothesis: other trees, planted as regularly
  std::int64_t num_operations = 0;
};

/// Registers the constellation of recent landmarks to old ones by the one rigid motion within the
/// covariance of the pose.
///
/// A matched tree counts in favour by the likelihood ratio of its residual against what another
/// place of this map would leave (planted_sd_m of the old landmarks); a tree in view of both that
/// only one side knows counts against, and so does the room that the pose leaves, in which some
/// place fits by chance: the fewer trees, or the less sure the pose, the better must they fit.
/// Found if the log-odds beat by closure_margin both the null hypothesis (another place, planted as
/// these are) and every other motion (the next tree, the next row).
Closure find_closure(const ClosureQuery& query, const SlamConfig& config);

}  // namespace orchard::pose
