// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "pose/graph/graph.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// The poses told while driving, as whoever hears POSE and TRAJECTORY has them.
///
/// Where they move otherwise than the wheels did, because a fix, a solve or another hypothesis
/// corrected the pose, a trajectory needs a key pose at both sides: interpolated across the jump,
/// its corrections would keep the jump as a motion of the robot.
class ToldPath {
 public:
  /// Base at a time, by the motion since a keyframe.
  struct Place {
    std::int64_t utime = 0;
    int keyframe = 0;
    Eigen::Vector3d T_keyframe_then = Eigen::Vector3d::Zero();
  };

  /// Adds the pose told at a place of the newest keyframe; replaces one of the same time.
  void tell(const Place& place, const Eigen::Vector3d& T_map_base, const SlamGraph& graph);

  /// Call when a trajectory tells the past anew: its poses are now those of the graph.
  void correct(const SlamGraph& graph);

  /// Call before the last trajectory: the pose told last is corrected, too.
  void end(const SlamGraph& graph);

  /// Returns the poses of a trajectory: the keyframes, and both sides of each jump, in order of
  /// time.
  std::vector<PoseEstimate> key_poses(const SlamGraph& graph) const;

 private:
  struct Told {
    Place place;
    Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  };

  std::optional<Told> before_, last_;
  std::vector<Place> sides_;  ///< of the jumps, ascending in time
};

}  // namespace orchard::pose
