// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// One motion as a reference (wheels, or fixes with heading) and the scanner saw it.
struct MotionPair {
  /// Of base: x [m], y [m], yaw [rad], relative to its pose at the start.
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  /// How `reference` changes if it is taken a second later [per s].
  Eigen::Vector3d reference_rate = Eigen::Vector3d::Zero();
  /// Of the laser frame, by matching scans.
  Eigen::Vector3d laser = Eigen::Vector3d::Zero();
  double duration_s = 0.0;
};

/// A figure that a drive tells, with its standard deviation.
struct Estimate {
  double value = 0.0;
  double sd = 0.0;
};

/// Where a scanner sits on its robot, and how far the reference is from the truth, as a drive tells
/// it. What the drive does not tell (the mount without a turn) has a large standard deviation.
struct MountEstimate {
  /// The scans turn the other way than the reference: one of the two is a mirror image. The other
  /// figures are those with the scans mirrored back.
  bool is_mirrored = false;
  Estimate mount_x_m, mount_y_m, mount_yaw_rad;  ///< of the laser in base
  Estimate way_scale;        ///< metres of the scans for a metre of the reference
  Estimate turn_scale;       ///< radians of the scans for a radian of the reference
  Estimate reference_lag_s;  ///< how much later the reference states a motion than the scans
  int num_pairs = 0;
};

/// Solves the motions of a drive for the mount: T_base_laser of every motion is the same, so that
/// reference * T_base_laser = T_base_laser * laser (Shiu and Ahmad 1989, in the plane), by robust
/// least squares. None for fewer than twenty motions.
std::optional<MountEstimate> estimate_mount(const std::vector<MotionPair>& pairs);

}  // namespace orchard::pose
