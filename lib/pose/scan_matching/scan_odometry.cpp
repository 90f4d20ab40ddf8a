// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_odometry.hpp"

#include <variant>

#include "geometry/pose2.hpp"
#include "pose/compose_covariance.hpp"

namespace orchard::pose {
using geometry::compose;

void ScanOdometry::add(const Measurement& measurement) {
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (!scan) return;
  const std::optional<MeasuredMotion> motion = motion_.add(*scan);
  if (!motion) {
    if (!utime_) utime_ = scan->utime;
    return;
  }
  covariance_ = compose_covariance(T_map_base_, covariance_, motion->T_from_to, motion->covariance);
  T_map_base_ = compose(T_map_base_, motion->T_from_to);
  utime_ = motion->utime_to;
  num_unreliable_ = motion->reliable ? 0 : num_unreliable_ + 1;
}

std::optional<PoseEstimate> ScanOdometry::estimate() const {
  if (!utime_) return std::nullopt;
  PoseEstimate pose;
  pose.utime = *utime_;
  pose.x_m = T_map_base_.x();
  pose.y_m = T_map_base_.y();
  pose.yaw_rad = T_map_base_.z();
  const Eigen::Matrix3d& P = covariance_;
  pose.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  return pose;
}

std::string ScanOdometry::warning() const {
  if (num_unreliable_ == 0) return {};
  return "LOST: the last " + std::to_string(num_unreliable_) +
         " scans could not be matched (too few returns, no overlap with earlier scans, or only "
         "smooth walls); the path is extrapolated from there on";
}

}  // namespace orchard::pose
