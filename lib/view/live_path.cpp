// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_path.hpp"

#include <cmath>

namespace orchard::view {
namespace {

/// Max number of recent poses kept to place scans: some seconds of any localization.
constexpr std::size_t kRecentMax = 200;

}  // namespace

void LivePath::take(const pose::PoseEstimate& pose) {
  if (last_ && pose.utime < last_->utime) recent_.clear();  // the clock was set back
  last_ = pose;
  if (recent_.size() >= kRecentMax) {
    recent_.erase(recent_.begin(), recent_.begin() + kRecentMax / 2);
  }
  recent_.push_back(pose);
  add_point({pose.x_m, pose.y_m});
}

void LivePath::take(const pose::TrajectoryPage& page) {
  const auto trajectory = collector_.add(page);
  if (!trajectory) return;
  points_.clear();
  ++generation_;
  for (const pose::PoseEstimate& pose : trajectory->poses) add_point({pose.x_m, pose.y_m});
  for (const pose::PoseEstimate& pose : recent_) {
    if (pose.utime >= trajectory->utime) add_point({pose.x_m, pose.y_m});
  }
}

std::optional<geometry::Pose2> LivePath::pose_at(std::int64_t utime) const {
  for (std::size_t k = recent_.size(); k-- > 1;) {
    const pose::PoseEstimate &before = recent_[k - 1], &after = recent_[k];
    if (utime < before.utime || utime > after.utime) continue;
    const auto whole_us = static_cast<double>(after.utime - before.utime);
    const double fraction =
        whole_us > 0.0 ? static_cast<double>(utime - before.utime) / whole_us : 1.0;
    const double turn_rad = std::remainder(after.yaw_rad - before.yaw_rad, 2.0 * M_PI);
    return geometry::Pose2{before.x_m + fraction * (after.x_m - before.x_m),
                           before.y_m + fraction * (after.y_m - before.y_m),
                           before.yaw_rad + fraction * turn_rad};
  }
  if (!recent_.empty() && recent_.back().utime == utime) {
    return geometry::Pose2{recent_.back().x_m, recent_.back().y_m, recent_.back().yaw_rad};
  }
  return std::nullopt;
}

void LivePath::add_point(const Eigen::Vector2d& p) {
  if (!points_.empty() && (p - points_.back()).norm() < step_m_) return;
  points_.push_back(p);
  if (points_.size() < kPointsMax) return;
  std::vector<Eigen::Vector2d> fewer;
  for (std::size_t k = 0; k < points_.size(); k += 2) fewer.push_back(points_[k]);
  points_ = std::move(fewer);
  step_m_ *= 2.0;
  ++generation_;
}

}  // namespace orchard::view
