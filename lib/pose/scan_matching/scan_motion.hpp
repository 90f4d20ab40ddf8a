// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "laser/blind_sector.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "pose/scan_matching/scan_motion_config.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// How base moved between two scans.
struct MeasuredMotion {
  std::int64_t utime_from = 0;  ///< of the first beam [us]
  std::int64_t utime_to = 0;
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();   ///< x [m], y [m], yaw [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of T_from_to
  double matched = 0.0;   ///< fraction of the later scan's points that fit what was seen before
  bool reliable = false;  ///< false: the motion is what was expected, or a guess
};

/// The motion of a rig from its scans alone: every scan is fitted to a local map of those before.
///
/// A scan is expected where the last motion, repeated, leads: in scans, not in seconds, because
/// recordings stretch time. What the scans do not tell (along a smooth wall, with too few returns)
/// has a covariance that says so. A pure function of the sequence of scans.
class ScanMotion {
 public:
  ScanMotion(const ScanMotionConfig& config, const laser::LaserConfig& mount,
             const laser::BlindSector& blind);

  /// The motion since the scan before; none for the first scan, and for one that is not later than
  /// the one before (it is left out). Every number in it is finite.
  std::optional<MeasuredMotion> add(const laser::Scan& scan);

 private:
  void remember(const std::vector<SurfacePoint>& points);

  ScanMotionConfig config_;
  laser::LaserConfig mount_;
  laser::BlindSector blind_;
  PointMap map_;
  std::optional<std::int64_t> utime_;
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_motion_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();  ///< per second, in base
  bool velocity_known_ = false;
  double travel_m_ = 0.0;
};

}  // namespace orchard::pose
