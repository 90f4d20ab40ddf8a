// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace orchard::laser {

/// Extrinsics and noise model of the laser. Section `laser`.
struct LaserConfig {
  double mount_x_m = 0.0;
  double mount_y_m = 0.0;
  double mount_yaw_rad = 0.0;
  double range_sd_m = 0.010;
  double range_sd_fraction = 0.01;
  /// 1-sigma per metre of range of the error common to all beams of one object.
  double target_sd_fraction = 0.0;
  /// Width of the laser spot at the scanner, and its growth per metre of range. An object also
  /// returns a beam that meets it with half its spot, so measured widths are too large by the spot.
  double spot_m = 0.0;
  double spot_rad = 0.0;

  /// 1-sigma of one range.
  double range_sd_at(double range_m) const {
    return std::hypot(range_sd_m, range_sd_fraction * range_m);
  }
  /// Width of the spot at a range: the amount by which a measured width is too large.
  double spot_at(double range_m) const { return spot_m + spot_rad * range_m; }
};

/// A second scanner; both contribute to one map. Section `laser_rear`.
struct RearLaserConfig : LaserConfig {
  bool enabled = false;
};

template <class Visitor>
void describe(Visitor& v, LaserConfig& c) {
  v.number("mount_x_m", c.mount_x_m, -10, 10, "m",
           "x of the laser in base (forward), measured with a ruler");
  v.number("mount_y_m", c.mount_y_m, -10, 10, "m",
           "y of the laser in base (left), measured with a ruler");
  v.number("mount_yaw_rad", c.mount_yaw_rad, -6.2832, 6.2832, "rad",
           "yaw of the laser in base, counter-clockwise; 0 = looks forward");
  v.number("range_sd_m", c.range_sd_m, 0, 1, "m",
           "standard deviation of a range, constant part; from the data sheet");
  v.number("range_sd_fraction", c.range_sd_fraction, 0, 0.2, "1",
           "standard deviation of a range per metre of range; from the data sheet");
  v.expert().number(
      "target_sd_fraction", c.target_sd_fraction, 0, 0.2, "1",
      "standard deviation per metre of range of the error common to all beams of an object");
  v.expert().number("spot_m", c.spot_m, 0, 0.2, "m",
                    "width of the laser spot at the scanner; from the data sheet, or the excess of "
                    "measured widths at short range");
  v.expert().number("spot_rad", c.spot_rad, 0, 0.05, "rad",
                    "divergence of the beam, subtracted from widths; from the data sheet or "
                    "`orchard calibrate trunks`");
}

template <class Visitor>
void describe(Visitor& v, RearLaserConfig& c) {
  v.flag("enabled", c.enabled, "true for a robot with a second scanner (SCAN.rear)");
  describe(v, static_cast<LaserConfig&>(c));
}

}  // namespace orchard::laser
