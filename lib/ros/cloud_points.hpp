// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ros/ros_messages.hpp"

namespace orchard::ros {

/// One point of a cloud as a slice needs it.
struct CloudPoint {
  double bearing_rad = 0.0;
  double range_m = 0.0;  ///< in the plane
  double z_m = 0.0;
  double time_s = 0.0;     ///< behind the cloud's stamp
  std::uint32_t line = 0;  ///< of the scanner; 0 when the cloud does not say
};

struct CloudPoints {
  std::vector<CloudPoint> points;  ///< finite and not at the origin, in the cloud's order
  bool has_time = false;
  bool has_lines = false;
};

/// The points of a cloud; none when it has no fields x, y and z.
std::optional<CloudPoints> read_points(const PointCloud& cloud);

}  // namespace orchard::ros
