// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/scan_matching/point_map.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// Lookup raster of the local map: each cell holds the likelihood of a return there, so that
/// thousands of poses of a scan can be scored quickly (Olson's correlative scan matching).
class LikelihoodField {
 public:
  LikelihoodField(const PointMap& map, const Eigen::Vector2d& centre_map, double half_side_m,
                  double kernel_m);

  /// Returns ScanMatcher::score up to the raster's resolution. `arms_map` are the points relative
  /// to base, rotated into the axes of map.
  double score(const std::vector<Eigen::Vector2d>& arms_map, const Eigen::Vector2d& base_map) const;

 private:
  double cell_m_;
  int side_;
  Eigen::Vector2d corner_map_;
  std::vector<std::uint8_t> fits_;  ///< 255 on a point of the map, row by row
};

}  // namespace orchard::pose
