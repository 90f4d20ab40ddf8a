// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// A laser return with the normal of its surface.
struct SurfacePoint {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();       ///< [m]
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< unit length if flat
  bool flat = false;  ///< on a smooth surface; gives no information along it
};

/// Returns the valid returns of a scan in base at the time of its first beam, in order of the
/// beams.
///
/// `velocity` is base's velocity (x [m/s], y [m/s], yaw [rad/s], in base), by which returns of
/// later beams are corrected if deskew is on and the scan states its beam period. Returns in the
/// blind sector, outside the range limits or not finite are left out.
std::vector<SurfacePoint> surface_points(const laser::Scan& scan, const laser::LaserConfig& mount,
                                         const laser::BlindSector& blind,
                                         const Eigen::Vector3d& velocity,
                                         const ScanMotionConfig& config);

/// Returns the first point in each square of side `side_m`, in order; all points for a side of 0.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double side_m);

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
