// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pose/slam/scan_points.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Keeps the newest keyframe in place among the landmarks around it: matches every scan, corrects
/// the last keyframes, and judges which landmarks are real. Starts a new session in the map where
/// the robot is lost.
class SlamTracker {
 public:
  explicit SlamTracker(const SlamConfig& config) : config_(config) {}

  /// Confirms landmarks that the newest keyframe observed often enough, and drops those that it
  /// should have observed and did not. Before the next keyframe is added.
  void finish_keyframe(SlamMap& map);

  /// After a keyframe was added: starts a new session if the robot is lost, and finds the landmarks
  /// that its scans may show.
  void start_keyframe(SlamMap& map);

  /// Associates one scan of the newest keyframe with landmarks; adds observations and landmarks.
  void match(const std::vector<ScanPoint>& points, SlamMap& map);

  /// Solves for the last keyframes of the session and their landmarks. False if there are none.
  bool correct_window(SlamMap& map);

  /// The last scans fitted more than one place.
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
  int num_scans_ = 0;         ///< of the newest keyframe
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
