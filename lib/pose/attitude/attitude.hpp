// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::pose {

/// physical: the length over which the tilt of a robot is one and the same: about its wheelbase.
inline constexpr double kBody_m = 1.0;
/// physical: by hand and level a sensor is mounted parallel to the wheels within half a degree.
inline constexpr double kMountSd_rad = 0.5 * geometry::kPi / 180.0;
/// physical: orchards are driven on slopes of up to 25 %, twice this.
inline constexpr double kDrivenSlopeSd = 0.12;

/// The tilt of base against gravity: pitch about y (nose down positive), then roll about x (left
/// side up positive). The level frame has base's origin and heading, and its z is up.
struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double sd_rad = 0.0;  ///< 1-sigma of each angle
};

/// physical: no robot drives on its side; more than 45 degrees are no tilt. False for NaN.
inline bool is_upright(const Attitude& a) {
  constexpr double kMax_rad = 0.785;
  return std::abs(a.roll_rad) < kMax_rad && std::abs(a.pitch_rad) < kMax_rad;
}

/// Rotation of vectors from base to the level frame.
inline Eigen::Matrix3d R_level_base(const Attitude& a) {
  const double cr = std::cos(a.roll_rad), sr = std::sin(a.roll_rad);
  const double cp = std::cos(a.pitch_rad), sp = std::sin(a.pitch_rad);
  Eigen::Matrix3d R;
  R << cp, sp * sr, sp * cr,  //
      0.0, cr, -sr,           //
      -sp, cp * sr, cp * cr;
  return R;
}

/// Rise per metre, along the level frame's x and y, of the plane that base stands on.
inline Eigen::Vector2d gradient_under(const Attitude& a) {
  return {-std::tan(a.pitch_rad), std::tan(a.roll_rad) / std::cos(a.pitch_rad)};
}

/// Rate of the heading [rad/s] by the angular rates about base's axes.
inline double heading_rate_radps(const Attitude& a, double about_y_radps, double about_z_radps) {
  return (about_y_radps * std::sin(a.roll_rad) + about_z_radps * std::cos(a.roll_rad)) /
         std::cos(a.pitch_rad);
}

}  // namespace orchard::pose
