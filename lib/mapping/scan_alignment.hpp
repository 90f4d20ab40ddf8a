// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace orchard::mapping {

/// A detection as used for alignment: its centre in map by the given pose.
struct AlignmentPoint {
  Eigen::Vector2d p_map;
  double sd_m = 0.0;  ///< of the detection only, without the pose error
};

/// Rigid motion of all points of one scan that registers them with the map: a rotation about the
/// robot, then a translation. Used for association only; it corrects no pose.
struct ScanAlignment {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();     ///< [m, m, rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< remaining covariance of the pose

  Eigen::Vector2d apply(const Eigen::Vector2d& p_map, const Eigen::Vector2d& robot_map) const;
};

/// Returns the nearest established landmark within `reach_m` of a point, or none.
using NearestLandmark =
    std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& p_map, double reach_m)>;

/// Registers the points of a scan with the landmarks within the uncertainty of the pose (covariance
/// of x, y, yaw): best kernel score over a range of rotations, then weighted least squares with the
/// pose as prior. `kernel_m`: distance scale beyond which a point no longer supports the fit. With
/// fewer than two supporting points the pose is left unchanged.
ScanAlignment align_scan(const std::vector<AlignmentPoint>& points,
                         const Eigen::Vector2d& robot_map, const Eigen::Matrix3d& pose_covariance,
                         double kernel_m, const NearestLandmark& nearest);

}  // namespace orchard::mapping
