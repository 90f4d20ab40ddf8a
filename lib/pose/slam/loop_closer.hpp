// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pose/slam/loop_closure.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Closes loops by landmarks: decides when to search for a closure, merges the matched landmarks,
/// solves the whole graph, and undoes the closure if the observations contradict it.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamConfig& config) : config_(config) {}

  /// Searches for a loop closure at the newest keyframe, at most every kClosureEvery_m of travel.
  void observe(SlamMap& map);

  /// Searches for a loop closure at the newest keyframe, regardless of the travel since the last
  /// search.
  void close(SlamMap& map);

  /// Call after the solve at the end of the drive: solves again while that merges landmarks that
  /// are one tree (see find_same_trees), because each merge makes others surer.
  void merge_duplicate_landmarks(SlamMap& map);

  /// True if the landmarks passed last fit the map in more than one way.
  bool is_ambiguous() const { return ambiguous_; }
  /// Number of accepted closures, and of those undone after the solve.
  int num_closures() const { return num_closures_; }
  int num_refuted() const { return num_refuted_; }
  /// Number of searches among older landmarks.
  int num_searches() const { return num_searches_; }
  std::int64_t num_operations() const { return num_operations_; }

 private:
  std::optional<ClosureQuery> query(const SlamMap& map) const;

  SlamConfig config_;
  double last_travel_m_ = 0.0;  ///< travel at the last search
  int num_keyframes_ = 0;       ///< number of keyframes when a closure was last tried
  bool ambiguous_ = false;
  int num_closures_ = 0;
  int num_refuted_ = 0;
  int num_searches_ = 0;
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
