// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "pose/localiser.hpp"
#include "pose/scan_matching/scan_motion.hpp"

namespace orchard::pose {

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
