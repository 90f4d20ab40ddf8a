// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <algorithm>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

bool is_before(const pose::PoseEstimate& pose, std::int64_t utime) { return pose.utime < utime; }

double turn(double from_rad, double to_rad, double share) {
  return geometry::wrap_angle_rad(from_rad + share * geometry::wrap_angle_rad(to_rad - from_rad));
}

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

std::optional<pose::PoseEstimate> PoseTrack::at(std::int64_t utime) const {
  if (poses_.empty()) return std::nullopt;
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), utime, is_before);
  if (after != poses_.end() && after->utime == utime) return *after;
  if (after == poses_.begin() || after == poses_.end()) {
    pose::PoseEstimate nearest = after == poses_.begin() ? poses_.front() : poses_.back();
    const std::int64_t away_us =
        nearest.utime > utime ? nearest.utime - utime : utime - nearest.utime;
    if (away_us > gap_max_us_) return std::nullopt;
    nearest.utime = utime;
    return nearest;
  }
  const pose::PoseEstimate& a = *(after - 1);
  const pose::PoseEstimate& b = *after;
  if (b.utime - a.utime > gap_max_us_) return std::nullopt;
  const double share =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  pose::PoseEstimate pose = a;
  pose.utime = utime;
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

}  // namespace orchard::mapping
