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
  std::array<double, 2> antenna_m{0.0, 0.0};
  /// Min standard deviation of a fix, by its quality, whatever the receiver claims.
  static constexpr double kSdFixed_m = 0.015;
  static constexpr double kSdFloat_m = 0.30;
  static constexpr double kSdDifferential_m = 0.60;
  static constexpr double kSdSingle_m = 1.5;
};

template <class Visitor>
void describe(Visitor& v, GnssConfig& c) {
  v.numbers(
      "datum", c.datum, -1000, 10000, "deg, deg, m",
      "latitude, longitude, altitude of the origin of the map; 0, 0, 0 = the first valid fix");
  v.numbers("antenna_m", c.antenna_m, -20, 20, "m",
            "x, y of the antenna in base, measured with a ruler");
  v.check(c.datum[0] > -90 && c.datum[0] < 90, "datum", "latitude must be in (-90, 90)");
  v.check(c.datum[1] >= -180 && c.datum[1] <= 180, "datum", "longitude must be in [-180, 180]");
}

}  // namespace orchard::pose
