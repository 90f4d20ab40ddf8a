// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace orchard::pose {

/// Correlation time of a receiver's error (decay to 1/e) [s]: errors of orbits and atmosphere
/// change more slowly, those of multipath within minutes.
inline constexpr double kReceiverMemory_s = 60.0;

/// Configuration of satellite fixes. Section `pose.gnss`.
struct GnssConfig {
  /// Latitude [deg], longitude [deg], altitude [m] of map's origin; map x points east. All 0: the
  /// first usable fix.
  std::array<double, 3> datum{0.0, 0.0, 0.0};
  std::array<double, 2> antenna_m{0.0, 0.0};  ///< of the antenna in base
  /// Min standard deviation of a fix, by its quality, whatever the receiver claims.
  double sd_fixed_m = 0.015;
  double sd_float_m = 0.30;
  double sd_differential_m = 0.60;
  double sd_single_m = 1.5;
};

template <class Visitor>
void describe(Visitor& v, GnssConfig& c) {
  v.numbers(
      "datum", c.datum, -1000, 10000, "deg, deg, m",
      "latitude, longitude, altitude of the origin of the map; 0, 0, 0 = the first valid fix");
  v.numbers("antenna_m", c.antenna_m, -20, 20, "m",
            "x, y of the antenna in base, measured with a ruler");
  v.expert().number(
      "sd_fixed_m", c.sd_fixed_m, 0.001, 100, "m",
      "min standard deviation assumed for an RTK fixed solution, whatever the receiver states");
  v.expert().number("sd_float_m", c.sd_float_m, 0.001, 100, "m",
                    "min standard deviation assumed for an RTK float solution");
  v.expert().number("sd_differential_m", c.sd_differential_m, 0.001, 100, "m",
                    "min standard deviation assumed for a differential fix");
  v.expert().number("sd_single_m", c.sd_single_m, 0.001, 100, "m",
                    "min standard deviation assumed for any other fix");
  v.check(c.sd_fixed_m <= c.sd_float_m, "sd_fixed_m", "must not be above sd_float_m");
  v.check(c.sd_float_m <= c.sd_differential_m, "sd_float_m", "must not be above sd_differential_m");
  v.check(c.sd_differential_m <= c.sd_single_m, "sd_differential_m",
          "must not be above sd_single_m");
  v.check(c.datum[0] > -90 && c.datum[0] < 90, "datum", "latitude must be in (-90, 90)");
  v.check(c.datum[1] >= -180 && c.datum[1] <= 180, "datum", "longitude must be in [-180, 180]");
}

}  // namespace orchard::pose
