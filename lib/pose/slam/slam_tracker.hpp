// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pose/pose_config.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam/slam_map.hpp"

namespace orchard::pose {

/// Tracks the newest keyframe relative to the landmarks around it: matches every scan, corrects the
/// last keyframes, confirms or drops landmarks, and starts a new session if the robot is lost.
class SlamTracker {
 public:
  explicit SlamTracker(const SlamConfig& config) : config_(config) {}

  /// Confirms landmarks observed from enough keyframes, and drops those that should have been
  /// observed and were not. Call before the next keyframe is added.
  void finish_keyframe(SlamMap& map);

  /// Starts a new session if the robot is lost, and updates the local map. Call after a keyframe
  /// was added.
  void start_keyframe(SlamMap& map);

  /// Associates one scan of the newest keyframe with landmarks; adds observations and landmarks.
  void match(const std::vector<ScanPoint>& points, SlamMap& map);

  /// Solves for the last keyframes of the session and their landmarks. Returns false if there are
  /// none.
  bool correct_window(SlamMap& map);

  /// True if the last scan fits more than one pose.
  bool is_ambiguous() const { return num_ambiguous_ > 0; }
  int num_matched() const { return num_matched_; }
  std::int64_t num_operations() const { return num_operations_; }

 private:
  void start_session(SlamMap& map, bool was_lost);
  bool is_elsewhere(const SlamMap& map);

  SlamConfig config_;
  int num_ambiguous_ = 0;     ///< ambiguous scans in a row
  int num_contradicted_ = 0;  ///< scans since the last match that should have matched
  int num_matched_ = 0;       ///< landmarks in the last scan
  int num_scans_ = 0;         ///< scans of the newest keyframe
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
