// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/told_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
namespace {

// derived: what a jump may move a trunk by, a third of a thin one's width, beside the robot and at
// the ten metres at which most are seen. Every fix moves the pose; few by so much.
constexpr double kJump_m = 0.03;
constexpr double kJump_rad = 0.003;

/// Returns the motion from the keyframe before to keyframe k.
Eigen::Vector3d motion_to(int k, const SlamGraph& graph) {
  const Keyframe& keyframe = graph.keyframes[k];
  return keyframe.motion.delta_with(graph.calibrations[keyframe.calibration]);
}

/// Returns T_a_b by the measured motion, not by the poses of the keyframes.
Eigen::Vector3d motion_between(const ToldPath::Place& a, const ToldPath::Place& b,
                               const SlamGraph& graph) {
  Eigen::Vector3d T_keyframe_b = Eigen::Vector3d::Zero();
  for (int k = a.keyframe + 1; k <= b.keyframe; ++k) {
    T_keyframe_b = compose(T_keyframe_b, motion_to(k, graph));
  }
  return between(a.T_keyframe_then, compose(T_keyframe_b, b.T_keyframe_then));
}

/// Interpolates from the keyframes at both sides, whose motion disagrees a little with their poses.
PoseEstimate pose_at(const ToldPath::Place& place, const SlamGraph& graph) {
  const Keyframe& a = graph.keyframes[place.keyframe];
  Eigen::Vector3d T = compose(a.T_map_base, place.T_keyframe_then);
  Eigen::Matrix3d P = a.covariance;
  const auto next = static_cast<std::size_t>(place.keyframe) + 1;
  if (next < graph.keyframes.size()) {
    const Keyframe& b = graph.keyframes[next];
    const double part =
        static_cast<double>(place.utime - a.utime) / static_cast<double>(b.utime - a.utime);
    const Eigen::Vector3d back =
        between(motion_to(place.keyframe + 1, graph), place.T_keyframe_then);
    Eigen::Vector3d off = compose(b.T_map_base, back) - T;
    off.z() = geometry::wrap_angle_rad(off.z());
    T += part * off;
    T.z() = geometry::wrap_angle_rad(T.z());
    P += part * (b.covariance - a.covariance);
  }
  return pose_estimate(place.utime, T, P);
}

}  // namespace

void ToldPath::tell(const Place& place, const Eigen::Vector3d& T_map_base, const SlamGraph& graph) {
  if (last_ && place.utime > last_->place.utime) {
    end(graph);
    before_ = last_;
  }
  last_ = Told{place, T_map_base};
}

void ToldPath::correct(const SlamGraph& graph) {
  if (!before_) return;
  const Place& place = before_->place;
  before_->T_map_base = compose(graph.keyframes[place.keyframe].T_map_base, place.T_keyframe_then);
}

void ToldPath::end(const SlamGraph& graph) {
  if (!before_) return;
  const Eigen::Vector3d jump =
      between(compose(before_->T_map_base, motion_between(before_->place, last_->place, graph)),
              last_->T_map_base);
  if (jump.head<2>().norm() <= kJump_m && std::abs(jump.z()) <= kJump_rad) return;
  for (const Place& side : {before_->place, last_->place}) {
    if (sides_.empty() || sides_.back().utime < side.utime) sides_.push_back(side);
  }
}

std::vector<PoseEstimate> ToldPath::key_poses(const SlamGraph& graph) const {
  std::vector<PoseEstimate> poses;
  poses.reserve(graph.keyframes.size() + sides_.size());
  auto side = sides_.begin();
  for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
    const Keyframe& keyframe = graph.keyframes[k];
    for (; side != sides_.end() && side->utime <= keyframe.utime; ++side) {
      if (side->utime < keyframe.utime) poses.push_back(pose_at(*side, graph));
    }
    poses.push_back(pose_estimate(keyframe.utime, keyframe.T_map_base, keyframe.covariance));
  }
  for (; side != sides_.end(); ++side) poses.push_back(pose_at(*side, graph));
  return poses;
}

}  // namespace orchard::pose
