// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "pose/attitude/attitude.hpp"

namespace orchard::pose {

/// What was known of the ground at one moment of a drive.
struct GroundReading {
  std::int64_t utime = 0;
  double x_m = 0.0;  ///< T_map_base
  double y_m = 0.0;
  double yaw_rad = 0.0;
  std::optional<Attitude> tilt;
  double antenna_height_m = 0.0;     ///< of the antenna in map, if its variance is not 0
  double antenna_variance_m2 = 0.0;  ///< of the fix; 0 = none
};

/// A place where the robot stood, with the ground below base.
struct GroundPoint {
  double x_m = 0.0;  ///< in map
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double z_m = 0.0;
  double variance_m2 = 0.0;                 ///< of z_m; neighbours err alike
  double own_variance_m2 = 0.0;             ///< of z_m, too; each point errs by itself
  std::optional<Eigen::Vector2d> gradient;  ///< rise per metre along map's x and y, by the tilt
  double slope_variance = 0.0;              ///< of its part across the way
};

/// The ground along the path of a drive, a point a metre.
using GroundProfile = std::vector<GroundPoint>;

/// Estimates the height of the ground along a path from the antenna's heights and from the tilt,
/// summed over the way and smoothed from both ends. `readings`: in order of time;
/// `p_base_antenna_m`: of the antenna in base, whose origin is on the ground.
///
/// Without any antenna height the profile is empty: heights by tilt alone drift by a hundredth of
/// the way and would be those of no frame. Without tilts, heights alone tell the ground along the
/// path: a point is then what its own fixes say, as unsmooth as they are. Antenna heights far off
/// the profile lose their weight. What of a fix's variance is its own, how long its neighbours
/// share the rest, and over which way a tilt errs alike, are those values under which the heights
/// of the drive are likeliest.
GroundProfile ground_along(const std::vector<GroundReading>& readings,
                           const Eigen::Vector3d& p_base_antenna_m);

}  // namespace orchard::pose
