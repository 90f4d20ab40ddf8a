// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pose/pose_config.hpp"
#include "pose/slam/slam_map.hpp"

namespace orchard::pose {

/// Returns the regularity of a planting pattern: the standard deviation [m] of the residuals of a
/// wrong registration, i.e. after the map is shifted by the offset between two neighbours. For rows
/// it is their irregularity, because a shift by a tree or a row fits nearly as well as the correct
/// one; for irregularly planted trees it grows with their spacing. Estimated from the lower
/// quartile of the distances to the nearest tree; infinite for fewer than four trees.
double lattice_residual_sd_m(const std::vector<Eigen::Vector2d>& trees);

/// Min number of matched trees; derived: two determine a motion, a third can contradict it.
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
///
/// The cost is bounded: of many motions those that most pairs of landmarks tell are scored, and
/// where one left out was told by as many as the best, or the pairs are too many, it is ambiguous.
Closure find_closure(const ClosureQuery& query, const SlamConfig& config);

/// Closes loops by landmarks: decides when to search for a closure, merges the matched landmarks,
/// solves the whole graph, and undoes the closure if the observations contradict it.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamConfig& config) : config_(config) {}

  /// Searches for a loop closure at the newest keyframe, at most every kClosureEvery_m of travel,
  /// and later after a costly search.
  void observe(SlamMap& map);

  /// Searches for a loop closure at the newest keyframe, regardless of the travel since the last
  /// search.
  void close(SlamMap& map);

  /// Call after the solve at the end of the drive: solves again while that merges landmarks that
  /// are one tree (see find_same_trees), because each merge makes others surer.
  void merge_duplicate_landmarks(SlamMap& map);

  /// True if the landmarks passed last fit the map in more than one way.
  bool is_ambiguous() const { return ambiguous_; }
  const LoopCounts& counts() const { return counts_; }

 private:
  std::optional<ClosureQuery> query(const SlamMap& map) const;

  SlamConfig config_;
  double last_travel_m_ = 0.0;        ///< travel at the last search
  std::int64_t last_operations_ = 0;  ///< of the last search
  int num_keyframes_ = 0;             ///< number of keyframes when a closure was last tried
  bool ambiguous_ = false;
  LoopCounts counts_;
};

}  // namespace orchard::pose
