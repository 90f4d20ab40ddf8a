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

/// Closes loops: decides when to look for one, merges the landmarks that it identifies, solves the
/// whole graph, and takes everything back where the observations refute it.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamConfig& config) : config_(config) {}

  /// Looks for a loop closure at the newest keyframe, at most every kClosureEvery_m of travel.
  void observe(SlamMap& map);

  /// Looks for one at the newest keyframe, however short the travel since the last one.
  void close(SlamMap& map);

  /// Makes one of trees that the map has twice, where all observations then fit. At the end of the
  /// drive, after all was solved.
  void merge_twins(SlamMap& map);

  /// The landmarks passed last fitted the map in more than one way.
  bool is_ambiguous() const { return ambiguous_; }
  /// Closures that stand, and those that were refuted.
  int num_closures() const { return num_closures_; }
  int num_refuted() const { return num_refuted_; }
  /// Places where one was looked for, among older landmarks.
  int num_asked() const { return num_asked_; }
  std::int64_t num_operations() const { return num_operations_; }

 private:
  std::optional<ClosureQuery> query(const SlamMap& map) const;

  SlamConfig config_;
  double last_travel_m_ = 0.0;  ///< where a closure was last looked for
  int num_keyframes_ = 0;       ///< when a closure was last tried
  bool ambiguous_ = false;
  int num_closures_ = 0;
  int num_refuted_ = 0;
  int num_asked_ = 0;
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
