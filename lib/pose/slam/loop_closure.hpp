// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Min number of matched trees: two determine a motion, a third can contradict it.
inline constexpr std::size_t kClosureTreesMin = 3;

/// A landmark for loop closure.
struct ClosureLandmark {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double width_m = 0.0;
  double width_sd_m = 0.1;
  double seen_m = 0.0;  ///< max range at which it was observed
};

/// Input of a loop closure search: landmarks of the last part of the path, and nearby landmarks
/// mapped long before.
struct ClosureQuery {
  std::vector<ClosureLandmark> recent;
  std::vector<ClosureLandmark> old;
  std::vector<Eigen::Vector2d> path;                ///< last part of the path, in map
  std::vector<Eigen::Vector2d> old_path;            ///< positions that old landmarks were seen from
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< position of the robot in map
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of its pose in map
};

/// Result of a loop closure search: the rigid motion about the pivot that registers recent
/// landmarks to old ones.
struct Closure {
  bool found = false;
  bool ambiguous = false;                           ///< a different motion fits about as well
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< x, y [m], yaw [rad]
  std::vector<std::pair<int, int>> matches;         ///< (recent, old) landmarks
  double log_odds = 0.0;  ///< against the null hypothesis: other trees with the same regularity
  std::int64_t num_operations = 0;
};

/// Searches for the rigid motion, within the covariance of the pose, that registers the recent
/// landmarks to old ones.
///
/// Each matched tree adds the log-likelihood ratio of its residual against that of a wrong
/// registration (see lattice_residual_sd_m of the old landmarks). Each tree in view of both paths
/// but mapped on only one subtracts, and so does the volume of the pose's covariance, within which
/// some motion fits by chance: fewer trees or a less certain pose require a better fit. A closure
/// is found if at least kClosureTreesMin trees match and the log-odds exceed by closure_margin both
/// the null hypothesis (another place with the same planting pattern) and every other motion (e.g.
/// shifted by a tree or a row).
Closure find_closure(const ClosureQuery& query, const SlamConfig& config);

}  // namespace orchard::pose
