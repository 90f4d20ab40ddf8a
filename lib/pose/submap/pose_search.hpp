// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/submap/occupancy_pyramid.hpp"

namespace orchard::pose {

/// Search window for the pose of a submap.
struct PoseSearchWindow {
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();  ///< centre of the window
  double half_side_m = 1.0;
  double half_turn_rad = 0.1;
};

/// Result of the search.
struct PoseSearchResult {
  bool found = false;      ///< false: no pose fits, or the limit of work was reached
  bool ambiguous = false;  ///< a different pose fits about as well
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();
  double score = 0.0;     ///< sum of the raster's values over the points, / kHit
  double on_known = 0.0;  ///< number of points in known cells
  std::int64_t num_operations = 0;
};

/// Finds the pose in the window at which a submap's points fit the raster best, by branch and bound
/// (correlative matching: Olson 2009; bounds: Hess et al. 2016).
///
/// The result is ambiguous if a pose farther away than `same_m`, or rotated by more than
/// `same_rad`, reaches (1 - lead) of the best score. A pure function with bounded work.
PoseSearchResult find_submap_pose(const std::vector<Eigen::Vector2d>& points,
                                  const OccupancyPyramid& raster, const PoseSearchWindow& window,
                                  double same_m, double same_rad, double lead);

}  // namespace orchard::pose
