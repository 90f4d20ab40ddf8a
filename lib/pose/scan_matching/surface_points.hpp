// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/scan_matching/scan_motion_config.hpp"

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

}  // namespace orchard::pose
