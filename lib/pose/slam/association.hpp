// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// An object of one scan, where base was at the keyframe.
struct ScanPoint {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  /// The same without what does not average out over the scans of a keyframe, which is floor_sd_m.
  Eigen::Matrix2d scan_covariance = Eigen::Matrix2d::Identity();
  double floor_sd_m = 0.0;
  double width_m = 0.0;
  double width_sd_m = 0.1;
};

/// A landmark that the scan may show.
struct AssociationCandidate {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< against the map around it
  double width_m = 0.0;
  double width_sd_m = 0.1;
};

/// Which object is which landmark.
struct Association {
  std::vector<int> landmark;  ///< of each point; -1 where none fits
  std::vector<bool> is_new;   ///< of each point: far enough from every landmark to be another
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();  ///< that the pairs agree on
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int num_matched = 0;
  bool ambiguous = false;  ///< another set of pairs, of another place, explains the scan as well
  std::int64_t num_operations = 0;  ///< pairs looked at: what the scan cost
};

/// Finds the largest set of pairs that fit together within the covariance of the predicted pose,
/// of the observations and of the landmarks: each pair must fit the pose that the pairs before it
/// have corrected (joint compatibility), started from every pair of the least ambiguous points. No
/// two points are one landmark. When a different set at a different place is as good, `ambiguous`
/// says so and nothing is matched.
Association associate(const std::vector<ScanPoint>& points,
                      const std::vector<AssociationCandidate>& candidates,
                      const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance,
                      const SlamConfig& config);

}  // namespace orchard::pose
