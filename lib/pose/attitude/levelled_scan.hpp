// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/attitude/attitude.hpp"
#include "pose/attitude/ground_plane.hpp"

namespace orchard::pose {

/// Projects scans of a tilted robot to the horizontal plane.
class ScanLeveller {
 public:
  /// `jump_m`, `jump_fraction`: range step between two objects (SegmentationConfig).
  ScanLeveller(const laser::LaserConfig& mount, double jump_m, double jump_fraction)
      : mount_(mount), jump_m_(jump_m), jump_fraction_(jump_fraction) {}

  /// Makes ranges and bearings of a scan horizontal, by the tilt at its first and last beam, and
  /// sets its sway and what is below it. Returns that may be of the ground become "nothing
  /// measured" (NaN), as do beams without a return that meet it, unless the mount's height is
  /// unknown (0).
  void level(laser::Scan& scan, const Attitude& first, const Attitude& last,
             const GroundPlane& ground);

 private:
  void set_directions(const laser::Scan& scan);
  void set_ranges(laser::Scan& scan, const laser::OverGround& ground);
  void leave_out_ground(laser::Scan& scan);

  /// Of a return above the ground's plane: may be ground, part of a surface that is, neither.
  enum class Height : std::uint8_t { kGround, kLow, kHigh };
  static Height height_of(float height_m, float variance_m2);

  laser::LaserConfig mount_;
  double jump_m_;
  double jump_fraction_;
  double bearing_min_rad_ = 0.0;  ///< those of the beams below
  double bearing_step_rad_ = 0.0;
  Eigen::ArrayXf bearings_rad_, part_;       ///< of the sweep that is over
  Eigen::ArrayXf x_, y_;                     ///< directions in base
  Eigen::ArrayXf level_x_, level_y_, rise_;  ///< of the newest scan, the rise over the ground
  std::vector<Height> heights_;
};

}  // namespace orchard::pose
