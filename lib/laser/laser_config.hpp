// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace orchard::laser {

/// Where the laser is mounted on the robot and how well it measures. Section `laser`.
struct LaserConfig {
  double mount_x_m = 0.0;  ///< of the laser in base
  double mount_y_m = 0.0;
  double mount_yaw_rad = 0.0;       ///< rotation from base to laser, counter-clockwise
  double range_sd_m = 0.010;        ///< 1-sigma of one range, the part that does not grow
  double range_sd_fraction = 0.01;  ///< 1-sigma of one range per metre of range
  /// 1-sigma per metre of range of the error that all beams of one object share.
  double target_sd_fraction = 0.0;
  /// A beam is a spot: what it half meets returns too. Its width where it leaves, and what it grows
  /// by per metre of range.
  double spot_m = 0.0;
  double spot_rad = 0.0;

  /// 1-sigma of one range.
  double range_sd_at(double range_m) const {
    return std::hypot(range_sd_m, range_sd_fraction * range_m);
  }
  /// What the spot adds to the width of what it meets.
  double spot_at(double range_m) const { return spot_m + spot_rad * range_m; }
};

/// A second scanner, whose objects join those of the first in one map. Section `laser_rear`.
struct RearLaserConfig : LaserConfig {
  bool enabled = false;
};

template <class Visitor>
void describe(Visitor& v, LaserConfig& c) {
  v.number("mount_x_m", c.mount_x_m, -10, 10, "m", "laser in base, forward");
  v.number("mount_y_m", c.mount_y_m, -10, 10, "m", "laser in base, left");
  v.number("mount_yaw_rad", c.mount_yaw_rad, -6.2832, 6.2832, "rad", "laser in base, turned left");
  v.number("range_sd_m", c.range_sd_m, 0, 1, "m", "1-sigma of a range, constant part");
  v.number("range_sd_fraction", c.range_sd_fraction, 0, 0.2, "1", "1-sigma per metre of range");
  v.expert().number("target_sd_fraction", c.target_sd_fraction, 0, 0.2, "1",
                    "1-sigma per metre of range of what all beams of an object share");
  v.expert().number(
      "spot_m", c.spot_m, 0, 0.2, "m",
      "width of the beam as it leaves; data sheets give it, callipers show it as what is "
      "measured too wide however near");
  v.expert().number(
      "spot_rad", c.spot_rad, 0, 0.05, "rad",
      "the beam's divergence; widths are less by it; `orchard calibrate trunks` measures it");
}

template <class Visitor>
void describe(Visitor& v, RearLaserConfig& c) {
  v.flag("enabled", c.enabled, "a second scanner sends SCAN.rear; its place and noise follow");
  describe(v, static_cast<LaserConfig&>(c));
}

}  // namespace orchard::laser
