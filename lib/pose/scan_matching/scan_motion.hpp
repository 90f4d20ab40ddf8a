// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/scan_matching/point_map.hpp"

namespace orchard::pose {

/// Motion of base between two scans.
struct MeasuredMotion {
  std::int64_t utime_from = 0;  ///< of the first beam [us]
  std::int64_t utime_to = 0;
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();   ///< x [m], y [m], yaw [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of T_from_to
  double matched = 0.0;   ///< fraction of the later scan's points that match the local map
  bool reliable = false;  ///< false: the motion is a prediction or a guess
};

/// Estimates the motion of base from scans alone, by registering each scan to a local map of the
/// previous ones.
///
/// The prediction repeats the last motion per scan, not per second, because time stamps of
/// recordings may be stretched. Directions that the scans do not determine (along a smooth wall,
/// with too few returns) get a large covariance. A pure function of the sequence of scans.
class ScanMotion {
 public:
  ScanMotion(const ScanMotionConfig& config, const laser::LaserConfig& mount,
             const laser::BlindSector& blind);

  /// Returns the motion since the previous scan. None for the first scan, and for a scan that is
  /// not later than the previous one, which is ignored. All numbers are finite.
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

/// Localiser of mode `odometry` with `motion: scans`: dead reckoning by the motions between scans,
/// from the map's origin at the first scan.
class ScanOdometry : public Localiser {
 public:
  ScanOdometry(const ScanMotionConfig& config, const laser::LaserConfig& mount,
               const laser::BlindSector& blind)
      : motion_(config, mount, blind) {}

  /// Takes scans; other measurements are ignored.
  void add(const Measurement& measurement) override;

  /// Returns the pose at the first beam of the last scan.
  std::optional<PoseEstimate> estimate() const override;

  std::string warning() const override;

 private:
  ScanMotion motion_;
  std::optional<std::int64_t> utime_;
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  int num_unreliable_ = 0;  ///< consecutive scans without a reliable motion
};

}  // namespace orchard::pose
