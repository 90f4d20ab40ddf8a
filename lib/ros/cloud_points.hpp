// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ros/ros_messages.hpp"

namespace orchard::ros {

/// One point of a cloud, with the properties needed for a slice.
struct CloudPoint {
  double bearing_rad = 0.0;
  double range_m = 0.0;  ///< in the plane
  double z_m = 0.0;
  double time_s = 0.0;     ///< time after the cloud's stamp
  std::uint32_t line = 0;  ///< scanner line (ring); 0 when the cloud has none
};

struct CloudPoints {
  std::vector<CloudPoint> points;  ///< finite and not at the origin, in the cloud's order
  bool has_time = false;
  bool has_lines = false;
};

/// Reads the points of a cloud; none when it has no fields x, y and z.
std::optional<CloudPoints> read_points(const PointCloud& cloud);

}  // namespace orchard::ros
