// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"

namespace orchard::mapping {
namespace {

/// derived: The first and last pose are valid this long beyond the ends: the robot moves 0.2 m at
/// most.
constexpr std::int64_t kBeyondEnds_us = 100'000;

double turn(double from_rad, double to_rad, double fraction) {
  return geometry::wrap_angle_rad(from_rad +
                                  fraction * geometry::wrap_angle_rad(to_rad - from_rad));
}

/// Interpolates between two poses; utime and seq are those of the first.
pose::PoseEstimate between(const pose::PoseEstimate& a, const pose::PoseEstimate& b,
                           double fraction) {
  pose::PoseEstimate pose = a;
  pose.x_m += fraction * (b.x_m - a.x_m);
  pose.y_m += fraction * (b.y_m - a.y_m);
  pose.yaw_rad = turn(a.yaw_rad, b.yaw_rad, fraction);
  pose.pitch_rad = turn(a.pitch_rad, b.pitch_rad, fraction);
  pose.roll_rad = turn(a.roll_rad, b.roll_rad, fraction);
  for (std::size_t i = 0; i < pose.covariance.size(); ++i) {
    pose.covariance[i] += fraction * (b.covariance[i] - a.covariance[i]);
  }
  return pose;
}

/// Correction at one key time: `told` is the pose received, `is` the corrected one.
struct Correction {
  pose::PoseEstimate told;
  pose::PoseEstimate is;

  /// Applies the rigid correction to another pose of the same drive.
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

/// Index of the first pose at or after `utime`; the number of poses if there is none. Searches from
/// the newest pose, which is usually asked for, so that old chunks stay on disk.
std::size_t PoseTrack::first_from(std::int64_t utime) const {
  std::size_t low = 0, high = poses_.size();
  for (std::size_t back = 1; back <= poses_.size(); back *= 2) {
    const std::size_t i = poses_.size() - back;
    if (poses_[i].utime < utime) {
      low = i + 1;
      break;
    }
    high = i;
  }
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (poses_[middle].utime < utime) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

void PoseTrack::add(const pose::PoseEstimate& pose) {
  const std::size_t at = first_from(pose.utime);
  if (at < poses_.size() && poses_[at].utime == pose.utime) return;
  poses_.push_back(pose);
  for (std::size_t i = poses_.size() - 1; i > at; --i) {
    poses_.edit(i) = pose::PoseEstimate(poses_[i - 1]);
    poses_.edit(i - 1) = pose;
  }
}

std::vector<pose::PoseEstimate> PoseTrack::poses() const {
  std::vector<pose::PoseEstimate> poses;
  poses.reserve(poses_.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) poses.push_back(poses_[i]);
  return poses;
}

bool PoseTrack::is_dense_at(std::int64_t utime, std::int64_t gap_max_us) const {
  std::size_t after = first_from(utime);
  if (after < poses_.size() && poses_[after].utime == utime) ++after;
  if (after < 2) return false;
  return poses_[after - 1].utime - poses_[after - 2].utime <= gap_max_us;
}

double PoseTrack::correct(const pose::Trajectory& trajectory) {
  const std::size_t end = first_from(trajectory.utime);
  if (end == 0) return 0.0;
  std::vector<Correction> corrections;
  for (const pose::PoseEstimate& key : trajectory.poses) {
    if (key.utime < poses_[0].utime || key.utime > poses_[end - 1].utime) continue;
    if (const auto told = at(key.utime)) corrections.push_back({*told, key});
  }
  if (corrections.empty()) return 0.0;
  double moved_m = 0.0;
  std::size_t next = 0;  // index of the first key time after the pose
  for (std::size_t i = 0; i < end; ++i) {
    pose::PoseEstimate& pose = poses_.edit(i);
    while (next < corrections.size() && corrections[next].is.utime <= pose.utime) ++next;
    const pose::PoseEstimate was = pose;
    if (next == 0) {
      pose = corrections.front().apply(was);
    } else if (next == corrections.size()) {
      pose = corrections.back().apply(was);
    } else {
      const Correction& a = corrections[next - 1];
      const Correction& b = corrections[next];
      pose = between(a.apply(was), b.apply(was),
                     static_cast<double>(was.utime - a.is.utime) /
                         static_cast<double>(b.is.utime - a.is.utime));
    }
    moved_m = std::max(moved_m, std::hypot(pose.x_m - was.x_m, pose.y_m - was.y_m));
  }
  return moved_m;
}

std::optional<pose::PoseEstimate> PoseTrack::at(std::int64_t utime) const {
  if (poses_.empty()) return std::nullopt;
  const std::size_t after = first_from(utime);
  if (after < poses_.size() && poses_[after].utime == utime) return poses_[after];
  if (after == 0 || after == poses_.size()) {
    pose::PoseEstimate nearest = after == 0 ? poses_[0] : poses_.back();
    const std::int64_t away_us =
        nearest.utime > utime ? nearest.utime - utime : utime - nearest.utime;
    if (away_us > std::min(gap_max_us_, kBeyondEnds_us)) return std::nullopt;
    nearest.utime = utime;
    return nearest;
  }
  const pose::PoseEstimate& a = poses_[after - 1];
  const pose::PoseEstimate& b = poses_[after];
  if (b.utime - a.utime > gap_max_us_) return std::nullopt;
  const double fraction =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  pose::PoseEstimate pose = between(a, b, fraction);
  pose.utime = utime;
  return pose;
}

namespace {

/// derived: Maximum duration of a sweep; later times do not belong to the scan.
constexpr std::int64_t kSweepMax_us = 1'000'000;

bool is_of_sweep(std::int64_t utime, std::int64_t scan_utime) {
  return utime > scan_utime && utime - scan_utime <= kSweepMax_us;
}

geometry::Pose2 pose_of(const pose::PoseEstimate& pose) {
  return {pose.x_m, pose.y_m, pose.yaw_rad};
}

void move(const geometry::Pose2& T_a_b, double& x_m, double& y_m) {
  const Eigen::Vector2d p_a = transform(T_a_b, {x_m, y_m});
  x_m = p_a.x();
  y_m = p_a.y();
}

}  // namespace

std::int64_t last_utime_of(const detection::Detections& detections) {
  std::int64_t last = detections.utime;
  for (const detection::Detection& d : detections.trunks) {
    if (is_of_sweep(d.utime, detections.utime)) last = std::max(last, d.utime);
  }
  return last;
}

detection::Detections deskewed(detection::Detections detections, const PoseTrack& track,
                               const pose::PoseEstimate& T_map_base) {
  for (detection::Detection& d : detections.trunks) {
    if (!is_of_sweep(d.utime, detections.utime)) continue;
    const auto T_map_then = track.at(d.utime);
    if (!T_map_then) continue;
    const geometry::Pose2 T_base_then = between(pose_of(T_map_base), pose_of(*T_map_then));
    move(T_base_then, d.centre_x_m, d.centre_y_m);
    move(T_base_then, d.surface_x_m, d.surface_y_m);
    d.covariance = geometry::rotated_covariance(d.covariance, T_base_then.yaw_rad);
  }
  return detections;
}

}  // namespace orchard::mapping
