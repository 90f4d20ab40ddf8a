// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "detection/detection.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// An object observed in one scan, in base at the keyframe.
struct ScanPoint {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  /// Covariance without floor_sd_m, the systematic error common to all scans of a keyframe.
  Eigen::Matrix2d scan_covariance = Eigen::Matrix2d::Identity();
  double floor_sd_m = 0.0;
  double width_m = 0.0;
  double width_sd_m = 0.1;
};

/// A landmark that may be visible in the scan.
struct AssociationCandidate {
  int landmark = -1;
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< against the map around it
  double width_m = 0.0;
  double width_sd_m = 0.1;
  bool confirmed = true;  ///< false: possibly clutter; only pairs within gate_m are tried
};

/// Result of the association of a scan with landmarks.
struct Association {
  std::vector<int> landmark;                             ///< per point; -1 for none
  std::vector<bool> is_new;                              ///< per point: far from all candidates
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();  ///< corrected by the pairs
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int num_matched = 0;
  bool ambiguous = false;           ///< a different position explains the scan about as well
  std::int64_t num_operations = 0;  ///< pairs tested: the cost of the scan
};

/// Associates the points of a scan with landmarks by joint compatibility: finds the pairs that fit
/// one common pose, given the covariances of the predicted pose, the observations and the
/// landmarks.
///
/// A hypothesis starts from a pair of one of the least ambiguous points and repeatedly adds the
/// nearest compatible pair by a Kalman update of the pose. The most likely hypothesis wins. Each
/// landmark is assigned to at most one point. If a hypothesis at another position is about as
/// likely, nothing is matched.
/// Source: in the spirit of Neira and Tardos 2001 (JCBB), greedy instead of branch and bound.
Association associate(const std::vector<ScanPoint>& points,
                      const std::vector<AssociationCandidate>& candidates,
                      const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance,
                      const SlamConfig& config);

/// Motion of base from the keyframe to the scan, and the velocity of base during the scan.
struct ScanMotionState {
  Eigen::Vector3d T_keyframe_scan = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Converts the objects of a scan to points in base at the keyframe, each corrected for the motion
/// up to its own beam. Wide or occluded objects and those labelled kObject get a larger covariance
/// because their centre is ill-defined. Objects too far away, too wide or not finite are left out.
/// `noise`: the variance of observations over what they claim.
std::vector<ScanPoint> scan_points(const detection::Detections& seen, const ScanMotionState& motion,
                                   double noise, const SlamConfig& config);

}  // namespace orchard::pose
