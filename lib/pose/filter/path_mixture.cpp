// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/path_mixture.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/angles.hpp"

namespace orchard::pose {
namespace {

Eigen::Vector3d off(const PoseEstimate& pose, const PoseEstimate& from) {
  return {pose.x_m - from.x_m, pose.y_m - from.y_m,
          geometry::wrap_angle_rad(pose.yaw_rad - from.yaw_rad)};
}

}  // namespace

std::vector<PoseEstimate> mean_path(const std::vector<CrediblePath>& paths) {
  double sum = 0.0;
  for (const CrediblePath& path : paths) sum += path.probability;
  std::vector<PoseEstimate> mixed = paths.front().poses;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    PoseEstimate& pose = mixed[i];
    const PoseEstimate first = pose;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const CrediblePath& path : paths) {
      mean += path.probability / sum * off(path.poses[i], first);
    }
    pose.x_m += mean.x();
    pose.y_m += mean.y();
    pose.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + mean.z());
    pose.covariance = {};
    for (const CrediblePath& path : paths) {
      const Eigen::Vector3d d = off(path.poses[i], first) - mean;
      const auto& own = path.poses[i].covariance;
      const double spread[] = {d.x() * d.x(), d.x() * d.y(), d.x() * d.z(),
                               d.y() * d.y(), d.y() * d.z(), d.z() * d.z()};
      for (std::size_t k = 0; k < own.size(); ++k) {
        pose.covariance[k] += path.probability / sum * (own[k] + spread[k]);
      }
    }
  }
  return mixed;
}

double notable_spread_m(const std::vector<CrediblePath>& paths) {
  std::vector<CrediblePath> exact = paths;
  for (CrediblePath& path : exact) {
    for (PoseEstimate& pose : path.poses) pose.covariance = {};
  }
  double largest2 = 0.0;
  const std::vector<PoseEstimate> spread = mean_path(exact);
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const auto position_variance = [](const PoseEstimate& pose) {
      return pose.covariance[0] + pose.covariance[3];
    };
    const double own2 = position_variance(paths.front().poses[i]);
    const double among2 = position_variance(spread[i]);
    if (among2 > own2) largest2 = std::max(largest2, among2);
  }
  return std::sqrt(largest2);
}

}  // namespace orchard::pose
