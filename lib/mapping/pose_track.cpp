// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"

namespace orchard::mapping {
namespace {

/// Before the first pose and after the last, base is where they say for so long: a robot moves at
/// most a tenth of a metre or two in it.
constexpr std::int64_t kBeyondEnds_us = 100'000;

bool is_before(const pose::PoseEstimate& pose, std::int64_t utime) { return pose.utime < utime; }

double turn(double from_rad, double to_rad, double share) {
  return geometry::wrap_angle_rad(from_rad + share * geometry::wrap_angle_rad(to_rad - from_rad));
}

/// `share` of the way from one pose to another; utime and seq are those of the first.
pose::PoseEstimate between(const pose::PoseEstimate& a, const pose::PoseEstimate& b, double share) {
  pose::PoseEstimate pose = a;
  pose.x_m += share * (b.x_m - a.x_m);
  pose.y_m += share * (b.y_m - a.y_m);
  pose.yaw_rad = turn(a.yaw_rad, b.yaw_rad, share);
  pose.pitch_rad = turn(a.pitch_rad, b.pitch_rad, share);
  pose.roll_rad = turn(a.roll_rad, b.roll_rad, share);
  for (std::size_t i = 0; i < pose.covariance.size(); ++i) {
    pose.covariance[i] += share * (b.covariance[i] - a.covariance[i]);
  }
  return pose;
}

/// At one key time: where base was told to be, and where it is known to have been.
struct Correction {
  pose::PoseEstimate told;
  pose::PoseEstimate is;

  /// Another pose of the same drive, moved as a rigid whole with this one.
  pose::PoseEstimate apply(pose::PoseEstimate pose) const {
    const double turn_rad = is.yaw_rad - told.yaw_rad;
    const Eigen::Vector2d p = geometry::transform(geometry::Pose2{is.x_m, is.y_m, turn_rad},
                                                  {pose.x_m - told.x_m, pose.y_m - told.y_m});
    pose.x_m = p.x();
    pose.y_m = p.y();
    pose.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + turn_rad);
    pose.covariance = is.covariance;
    return pose;
  }
};

}  // namespace

void PoseTrack::add(const pose::PoseEstimate& pose) {
  const auto at = std::lower_bound(poses_.begin(), poses_.end(), pose.utime, is_before);
  if (at != poses_.end() && at->utime == pose.utime) return;
  poses_.insert(at, pose);
}

bool PoseTrack::is_dense_at(std::int64_t utime, std::int64_t gap_max_us) const {
  const auto after = std::upper_bound(
      poses_.begin(), poses_.end(), utime,
      [](std::int64_t t, const pose::PoseEstimate& pose) { return t < pose.utime; });
  if (after - poses_.begin() < 2) return false;
  return (after - 1)->utime - (after - 2)->utime <= gap_max_us;
}

double PoseTrack::correct(const pose::Trajectory& trajectory) {
  const auto end = std::lower_bound(poses_.begin(), poses_.end(), trajectory.utime, is_before);
  if (end == poses_.begin()) return 0.0;
  std::vector<Correction> corrections;
  for (const pose::PoseEstimate& key : trajectory.poses) {
    if (key.utime < poses_.front().utime || key.utime > (end - 1)->utime) continue;
    if (const auto told = at(key.utime)) corrections.push_back({*told, key});
  }
  if (corrections.empty()) return 0.0;
  double moved_m = 0.0;
  std::size_t next = 0;  // the first key time after the pose
  for (auto pose = poses_.begin(); pose != end; ++pose) {
    while (next < corrections.size() && corrections[next].is.utime <= pose->utime) ++next;
    const pose::PoseEstimate was = *pose;
    if (next == 0) {
      *pose = corrections.front().apply(was);
    } else if (next == corrections.size()) {
      *pose = corrections.back().apply(was);
    } else {
      const Correction& a = corrections[next - 1];
      const Correction& b = corrections[next];
      *pose = between(a.apply(was), b.apply(was),
                      static_cast<double>(was.utime - a.is.utime) /
                          static_cast<double>(b.is.utime - a.is.utime));
    }
    moved_m = std::max(moved_m, std::hypot(pose->x_m - was.x_m, pose->y_m - was.y_m));
  }
  return moved_m;
}

std::optional<pose::PoseEstimate> PoseTrack::at(std::int64_t utime) const {
  if (poses_.empty()) return std::nullopt;
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), utime, is_before);
  if (after != poses_.end() && after->utime == utime) return *after;
  if (after == poses_.begin() || after == poses_.end()) {
    pose::PoseEstimate nearest = after == poses_.begin() ? poses_.front() : poses_.back();
    const std::int64_t away_us =
        nearest.utime > utime ? nearest.utime - utime : utime - nearest.utime;
    if (away_us > std::min(gap_max_us_, kBeyondEnds_us)) return std::nullopt;
    nearest.utime = utime;
    return nearest;
  }
  const pose::PoseEstimate& a = *(after - 1);
  const pose::PoseEstimate& b = *after;
  if (b.utime - a.utime > gap_max_us_) return std::nullopt;
  const double share =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  pose::PoseEstimate pose = between(a, b, share);
  pose.utime = utime;
  return pose;
}

}  // namespace orchard::mapping
