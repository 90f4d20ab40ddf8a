// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/deskew.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"

namespace orchard::mapping {
namespace {

/// Maximum duration of a sweep; later times do not belong to the scan.
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
