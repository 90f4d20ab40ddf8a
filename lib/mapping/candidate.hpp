// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/pose_composition.hpp"
#include "mapping/scan_alignment.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// A detection composed into the map frame, before association.
struct Candidate {
  const detection::Detection* detection = nullptr;  ///< owned by the scan's Detections
  Eigen::Vector2d p_map;                            ///< composed with the given pose
  Eigen::Vector2d p_aligned;                        ///< p_map moved by the scan alignment
  Eigen::Matrix2d covariance;                       ///< of p_map: detection and pose [m2]
  Eigen::Matrix2d aligned_covariance;  ///< of p_aligned: detection and remaining pose error [m2]
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
