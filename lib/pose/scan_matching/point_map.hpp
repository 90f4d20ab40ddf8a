// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "pose/scan_matching/scan_motion_config.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// Local map of points on a grid of cells that wraps around, so that new cells replace those far
/// behind the robot. Memory and the cost of a query are bounded for any length of drive.
class PointMap {
 public:
  explicit PointMap(const ScanMotionConfig& config);

  void clear();

  /// Adds a point [m, map]; `travel_m` is the travel so far. A point nearer to an existing one than
  /// the map's spacing only refreshes the existing one.
  void insert(const SurfacePoint& point, double travel_m);

  /// Hides points last seen before this travel from nearest() and visit().
  void forget_before(double travel_m) { oldest_m_ = travel_m; }

  /// Returns the nearest point within `radius_m` and sets `distance2_m2`; null if there is none.
  const SurfacePoint* nearest(const Eigen::Vector2d& p_map, double radius_m,
                              double& distance2_m2) const;

  /// Calls `visitor` with every point [m] in the cells of a square, in order of the cells.
  void visit(const Eigen::Vector2d& centre_map, double half_side_m,
             const std::function<void(const Eigen::Vector2d&)>& visitor) const;

  bool empty() const { return empty_; }

 private:
  struct Entry {
    SurfacePoint point;
    double seen_m = 0.0;
  };
  struct Cell {
    std::int32_t ix = 0, iy = 0;
    std::vector<Entry> entries;
  };

  std::int32_t index(double coordinate_m) const;
  std::size_t slot(std::int32_t ix, std::int32_t iy) const {
    return (static_cast<std::size_t>(ix & mask_) << bits_) | static_cast<std::size_t>(iy & mask_);
  }

  double cell_m_;
  double spacing2_m2_;
  std::size_t cell_points_max_;
  double oldest_m_ = -1.0;
  int bits_ = 0;
  std::int32_t mask_ = 0;
  bool empty_ = true;
  std::vector<Cell> cells_;
};

}  // namespace orchard::pose
