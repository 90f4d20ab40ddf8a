// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/slam_config.hpp"

namespace orchard::pose {

/// An object of one scan, in base at the keyframe.
struct ScanPoint {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  /// The same without the systematic error of all scans of a keyframe, which is floor_sd_m.
  Eigen::Matrix2d scan_covariance = Eigen::Matrix2d::Identity();
  double floor_sd_m = 0.0;
  double width_m = 0.0;
  double width_sd_m = 0.1;
};

/// A landmark that the scan may observe.
struct AssociationCandidate {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< against the map around it
  double width_m = 0.0;
  double width_sd_m = 0.1;
  bool confirmed = true;  ///< else perhaps clutter, which may not move the pose
};

/// Which landmark each object of a scan is.
struct Association {
  std::vector<int> landmark;                             ///< of each point; -1 for none
  std::vector<bool> is_new;                              ///< of each point: far from every landmark
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();  ///< corrected by the pairs
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int num_matched = 0;
  bool ambiguous = false;           ///< a pose elsewhere explains the scan as well
  std::int64_t num_operations = 0;  ///< pairs tested: the cost of the scan
};

/// Data association by joint compatibility: the pairs that fit one pose together, within the
/// covariances of the predicted pose, of the observations and of the landmarks.
///
/// Each hypothesis starts from a pair of one of the least ambiguous points and grows by the nearest
/// compatible pair, each a Kalman update of the pose; the most likely one wins. No two points are
/// one landmark. Nothing is matched where a hypothesis at another position is about as likely.
/// Source: in the spirit of Neira and Tardos 2001 (JCBB), greedy instead of branch and bound.
Association associate(const std::vector<ScanPoint>& points,
                      const std::vector<AssociationCandidate>& candidates,
                      const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance,
                      const SlamConfig& config);

}  // namespace orchard::pose
