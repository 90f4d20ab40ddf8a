// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/sweep.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

/// No scanner sweeps longer; a time beyond it is none of this scan.
constexpr std::int64_t kSweepMax_us = 1'000'000;

bool is_of_sweep(std::int64_t utime, std::int64_t scan_utime) {
  return utime > scan_utime && utime - scan_utime <= kSweepMax_us;
}

/// T_a_b in the plane.
struct PlaneMotion {
  double x_m, y_m, c, s;

  void move(double& x, double& y) const {
    const double moved_x = c * x - s * y + x_m;
    y = s * x + c * y + y_m;
    x = moved_x;
  }
};

/// Takes points of base at pose `b` to base at pose `a`.
PlaneMotion between(const pose::PoseEstimate& a, const pose::PoseEstimate& b) {
  const double turn_rad = b.yaw_rad - a.yaw_rad;
  const double c = std::cos(a.yaw_rad), s = std::sin(a.yaw_rad);
  const double x_m = b.x_m - a.x_m, y_m = b.y_m - a.y_m;
  return {c * x_m + s * y_m, -s * x_m + c * y_m, std::cos(turn_rad), std::sin(turn_rad)};
}

}  // namespace

std::int64_t last_utime_of(const detection::Detections& detections) {
  std::int64_t last = detections.utime;
  for (const detection::Detection& d : detections.trunks) {
    if (is_of_sweep(d.utime, detections.utime)) last = std::max(last, d.utime);
  }
  return last;
}

detection::Detections unswept(detection::Detections detections, const PoseTrack& track,
                              const pose::PoseEstimate& T_map_base) {
  for (detection::Detection& d : detections.trunks) {
    if (!is_of_sweep(d.utime, detections.utime)) continue;
    const auto T_map_then = track.at(d.utime);
    if (!T_map_then) continue;
    const PlaneMotion T_base_then = between(T_map_base, *T_map_then);
    T_base_then.move(d.centre_x_m, d.centre_y_m);
    T_base_then.move(d.surface_x_m, d.surface_y_m);
    const double c = T_base_then.c, s = T_base_then.s;
    const auto [xx, xy, yy] = d.covariance;
    d.covariance = {c * c * xx - 2.0 * c * s * xy + s * s * yy,
                    c * s * (xx - yy) + (c * c - s * s) * xy,
                    s * s * xx + 2.0 * c * s * xy + c * c * yy};
  }
  return detections;
}

}  // namespace orchard::mapping
