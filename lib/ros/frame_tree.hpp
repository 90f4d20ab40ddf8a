// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

#include "ros/ros_messages.hpp"

namespace orchard::ros {

/// The frames of a robot as its /tf and /tf_static tell them: which are fixed to each other, and
/// which moves in the world.
class FrameTree {
 public:
  /// The first transform of a frame counts; a later, different one makes its joint a moving one. So
  /// is every joint to a frame of the world (REP 105: odom, map, world, earth).
  void add(const Transform& transform);

  /// T_a_b of frames that are fixed to each other; none otherwise.
  std::optional<Eigen::Isometry3d> between(const std::string& a, const std::string& b) const;

  /// The uppermost frame to which this one is fixed; itself if it is in no transform.
  std::string root_of(const std::string& frame) const { return climb(frame).first; }

  /// The frame in which this one moves; empty if there is none.
  std::string world_of(const std::string& frame) const;

  bool empty() const { return joints_.empty(); }

 private:
  struct Joint {
    Transform transform;
    bool is_moving = false;
  };
  /// The root of a frame, and T_root_frame.
  std::pair<std::string, Eigen::Isometry3d> climb(std::string frame) const;

  std::map<std::string, Joint> joints_;  ///< by the child
};

}  // namespace orchard::ros
