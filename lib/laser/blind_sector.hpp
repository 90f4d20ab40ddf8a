// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::laser {

/// The sector of bearings (laser frame) in which the scanner sees its own robot.
struct BlindSector {
  double centre_rad = 0.0;
  double half_width_rad = 0.0;  ///< 0 = no such sector

  bool contains(double bearing_rad) const {
    return half_width_rad > 0.0 &&
           std::abs(geometry::wrap_angle_rad(bearing_rad - centre_rad)) <= half_width_rad;
  }
};

}  // namespace orchard::laser
