// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/scan_matching/point_map.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// A picture of the local map around a place in which every cell holds how well a return would fit
/// there, so that thousands of places of a scan can be tried (Olson's correlative scan matching).
class FitRaster {
 public:
  FitRaster(const PointMap& map, const Eigen::Vector2d& centre_map, double half_side_m,
            double kernel_m);

  /// As ScanMatcher::score, to the raster's resolution, for points turned into the map's axes.
  double score(const std::vector<Eigen::Vector2d>& arms_map, const Eigen::Vector2d& base_map) const;

 private:
  double cell_m_;
  int side_;
  Eigen::Vector2d corner_map_;
  std::vector<std::uint8_t> fits_;  ///< 255 on a point of the map, row by row
};

}  // namespace orchard::pose
