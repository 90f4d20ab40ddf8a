// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/path_mixture.hpp"

#include <Eigen/Core>
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

}  // namespace orchard::pose
