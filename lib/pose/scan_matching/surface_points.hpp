// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "laser/blind_sector.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/scan_matching/scan_motion_config.hpp"

namespace orchard::pose {

/// A return of the laser and the surface that it lies on.
struct SurfacePoint {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();       ///< [m]
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< unit length when flat
  bool flat = false;  ///< on something smooth, along which it tells nothing
};

/// The believable returns of a scan in base at the time of its first beam, in order of the beams.
///
/// `velocity` is base's motion per second (x, y, yaw in base), by which returns of later beams are
/// moved when the scan states its beam period. What the blind sector or the range limits exclude,
/// and what is not finite, is left out.
std::vector<SurfacePoint> surface_points(const laser::Scan& scan, const laser::LaserConfig& mount,
                                         const laser::BlindSector& blind,
                                         const Eigen::Vector3d& velocity,
                                         const ScanMotionConfig& config);

/// The first point in each square of that side, in order; all of them for a side of 0.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double side_m);

}  // namespace orchard::pose
