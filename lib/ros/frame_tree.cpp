// SPDX-License-Identifier: BSD-3-Clause
#include "ros/frame_tree.hpp"

#include <utility>

namespace orchard::ros {
namespace {

bool is_world(const std::string& frame) {
  return frame == "odom" || frame == "map" || frame == "world" || frame == "earth";
}

}  // namespace

void FrameTree::add(const Transform& transform) {
  constexpr std::size_t kMaxFrames = 1000;  // physical: more than any robot has
  if (joints_.size() >= kMaxFrames && joints_.count(transform.child) == 0) return;
  Joint& joint = joints_.try_emplace(transform.child, Joint{transform, is_world(transform.parent)})
                     .first->second;
  joint.is_moving = joint.is_moving || joint.transform.parent != transform.parent ||
                    !joint.transform.T_parent_child.isApprox(transform.T_parent_child);
}

std::pair<std::string, Eigen::Isometry3d> FrameTree::climb(std::string frame) const {
  Eigen::Isometry3d T_root_frame = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < joints_.size(); ++i) {  // no longer: transforms in a circle
    const auto joint = joints_.find(frame);
    if (joint == joints_.end() || joint->second.is_moving) break;
    T_root_frame = joint->second.transform.T_parent_child * T_root_frame;
    frame = joint->second.transform.parent;
  }
  return {std::move(frame), T_root_frame};
}

std::optional<Eigen::Isometry3d> FrameTree::between(const std::string& a,
                                                    const std::string& b) const {
  const auto [root_a, T_root_a] = climb(a);
  const auto [root_b, T_root_b] = climb(b);
  if (root_a != root_b) return std::nullopt;
  return T_root_a.inverse() * T_root_b;
}

std::string FrameTree::world_of(const std::string& frame) const {
  const auto joint = joints_.find(frame);
  return joint != joints_.end() && joint->second.is_moving ? joint->second.transform.parent : "";
}

}  // namespace orchard::ros
