// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fixes.hpp"

#include <cmath>
#include <variant>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {

Eigen::Matrix3d fix_covariance(const PoseFix& fix, const PoseConfig& config) {
  const std::array<double, 6>& c = fix.covariance;
  Eigen::Matrix3d R;
  R << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  if (!(c[0] > 0.0 && c[3] > 0.0 && c[1] * c[1] < c[0] * c[3])) {
    R.setZero();
    R(0, 0) = R(1, 1) = geometry::square(config.fix_position_sd_m);
    R(2, 2) = c[5];
  }
  if (!(c[5] > 0.0)) {
    R.row(2).setZero();
    R.col(2).setZero();
    R(2, 2) = geometry::square(config.fix_yaw_sd_rad);
  }
  return R;
}

void Fixes::add(const Measurement& measurement) {
  const auto* fix = std::get_if<PoseFix>(&measurement);
  if (fix == nullptr) return;
  const Eigen::Matrix3d R = fix_covariance(*fix, config_);
  PoseEstimate pose;
  pose.utime = fix->utime;
  pose.x_m = fix->x_m;
  pose.y_m = fix->y_m;
  pose.yaw_rad = geometry::wrap_angle_rad(fix->yaw_rad);
  pose.covariance = {R(0, 0), R(0, 1), R(0, 2), R(1, 1), R(1, 2), R(2, 2)};
  if (!fix->has_yaw) {
    if (!baseline_start_) baseline_start_ = *fix;
    const double dx_m = fix->x_m - baseline_start_->x_m;
    const double dy_m = fix->y_m - baseline_start_->y_m;
    const double way_m = std::hypot(dx_m, dy_m);
    if (way_m >= config_.heading_baseline_m) {
      baseline_start_ = *fix;
      pose.yaw_rad = std::atan2(dy_m, dx_m);
      pose.covariance[5] = (R(0, 0) + R(1, 1)) / geometry::square(way_m);
    } else if (estimate_) {
      pose.yaw_rad = estimate_->yaw_rad;
      pose.covariance[5] = estimate_->covariance[5];
    } else {
      return;
    }
    pose.covariance[2] = pose.covariance[4] = 0.0;
  }
  estimate_ = pose;
}

}  // namespace orchard::pose
