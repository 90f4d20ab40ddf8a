// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/submap/place_raster.hpp"

namespace orchard::pose {

/// Where a submap may lie.
struct PlaceWindow {
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();  ///< the middle of the window
  double half_side_m = 1.0;
  double half_turn_rad = 0.1;
};

/// Where it lies.
struct PlaceFound {
  bool found = false;      ///< false: nowhere at all, or too much work
  bool ambiguous = false;  ///< a place elsewhere fits about as well
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();
  double score = 0.0;  ///< points on returns less what beams passed through; at most their number
  double on_known = 0.0;  ///< points on ground that the raster knows
  std::int64_t num_operations = 0;
};

/// The place of a submap's points in the window that fits the raster best, by branch and bound over
/// all of them (correlative matching: Olson 2009; bounds: Hess et al. 2016).
///
/// Ambiguous where a place farther away than `same_m` or turned by more than `same_rad` reaches the
/// best score but for the fraction `lead`. A pure function; bounded in work.
PlaceFound find_place(const std::vector<Eigen::Vector2d>& points, const PlaceRaster& raster,
                      const PlaceWindow& window, double same_m, double same_rad, double lead);

}  // namespace orchard::pose
