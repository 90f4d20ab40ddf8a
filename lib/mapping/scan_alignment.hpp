// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace orchard::mapping {

/// A detection as the alignment sees it: its centre in map by the given pose.
struct AlignmentPoint {
  Eigen::Vector2d p_map;
  double sd_m = 0.0;  ///< of the detection alone
};

/// How the objects of one scan are moved together so that they fall on the map: a turn about the
/// robot, then a shift. Never leaves the mapper: it decides who is who, it corrects no pose.
struct ScanAlignment {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();     ///< [m, m, rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< what is left of the pose's

  Eigen::Vector2d apply(const Eigen::Vector2d& p_map, const Eigen::Vector2d& robot_map) const;
};

/// Nearest established landmark within reach of a point, or none.
using NearestLandmark =
    std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& p_map, double reach_m)>;

/// Fits the points of a scan to the landmarks within what the pose's covariance (x, y, yaw) allows:
/// the best of a fan of turns by kernel score, then weighted least squares with the pose as prior.
/// `kernel_m` is the distance at which a point stops to support a fit. Fewer than two supporting
/// points leave the pose as it is.
ScanAlignment align_scan(const std::vector<AlignmentPoint>& points,
                         const Eigen::Vector2d& robot_map, const Eigen::Matrix3d& pose_covariance,
                         double kernel_m, const NearestLandmark& nearest);

}  // namespace orchard::mapping
