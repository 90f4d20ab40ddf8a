// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/free_space.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Transforms points at the height of base from base to map; the coefficients are computed once per
/// scan.
///
/// Shalal et al. 2013, eqs. 11-12, generalised to all three angles; the z component is dropped.
class PoseComposition {
 public:
  explicit PoseComposition(const pose::PoseEstimate& T_map_base);

  /// Position in map of a point in base [m].
  Eigen::Vector2d apply(double x_base_m, double y_base_m) const {
    // Shalal et al. 2013, eq. 11 (x) and eq. 12 (y), for any orientation of the robot.
    return {xx_ * x_base_m + xy_ * y_base_m + x_m_, yx_ * x_base_m + yy_ * y_base_m + y_m_};
  }

 private:
  double xx_, xy_, x_m_;
  double yx_, yy_, y_m_;
};

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

/// A detection composed into the map frame, before association.
struct Candidate {
  const detection::Detection* detection = nullptr;  ///< owned by the scan's Detections
  Eigen::Vector2d p_map;                            ///< composed with the given pose
  Eigen::Vector2d p_aligned;                        ///< p_map moved by the scan alignment
  Eigen::Matrix2d covariance;                       ///< of p_map: detection and pose [m2]
  Eigen::Matrix2d aligned_covariance;  ///< of p_aligned: detection and remaining pose error [m2]
  Clearance clearance = Clearance::kUntold;
};

/// Composes the detections of a scan with its pose (eqs. 11-12); p_aligned is set to p_map. Drops
/// detections farther from base than `observation_range_max_m` and those without a finite position.
std::vector<Candidate> compose(const detection::Detections& detections,
                               const pose::PoseEstimate& T_map_base,
                               const PoseComposition& composition, double observation_range_max_m);

/// Aligns the candidates of a scan with the map by one common motion; sets p_aligned and its
/// covariance. Objects are moved but do not take part in the fit, because bushes look different
/// from each side. Returns T_map_base with the same motion applied.
pose::PoseEstimate align(std::vector<Candidate>& candidates, const pose::PoseEstimate& T_map_base,
                         double kernel_m, const NearestLandmark& nearest);

/// 1-sigma per axis of a map point caused by the covariance of the pose [m].
double pose_induced_sd_m(const pose::PoseEstimate& T_map_base, const Eigen::Vector2d& p_map);

}  // namespace orchard::mapping
