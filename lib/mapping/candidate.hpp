// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/pose_composition.hpp"
#include "mapping/scan_alignment.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// A detection in map, on its way to a landmark.
struct Candidate {
  const detection::Detection* detection = nullptr;  ///< lives as long as the scan's Detections
  Eigen::Vector2d p_map;                            ///< by the pose
  Eigen::Vector2d p_aligned;                        ///< and moved with its scan onto the map
  Eigen::Matrix2d covariance;                       ///< of p_map: detection and pose [m2]
  Eigen::Matrix2d aligned_covariance;  ///< of p_aligned: detection and what is left of the pose's
};

/// Composes the detections of a scan with its pose (eqs. 11-12); p_aligned is p_map as yet. What
/// lies farther from base than `observation_range_max_m`, or nowhere, is left out.
std::vector<Candidate> compose(const detection::Detections& detections,
                               const pose::PoseEstimate& T_map_base,
                               const PoseComposition& composition, double observation_range_max_m);

/// Moves the candidates of a scan together onto the map: sets p_aligned and its covariance. Objects
/// do not lead: bushes look different from each side. T_map_base moved likewise.
pose::PoseEstimate align(std::vector<Candidate>& candidates, const pose::PoseEstimate& T_map_base,
                         double kernel_m, const NearestLandmark& nearest);

/// 1-sigma per axis that a pose's covariance gives a point of map [m].
double sd_at(const pose::PoseEstimate& T_map_base, const Eigen::Vector2d& p_map);

}  // namespace orchard::mapping
