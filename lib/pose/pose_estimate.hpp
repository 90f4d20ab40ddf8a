// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace orchard::pose {

/// Pose of base in map at one time, T_map_base, with its covariance.
struct PoseEstimate {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;                ///< in (-pi, pi]
  double pitch_rad = 0.0;              ///< 0 when unknown
  double roll_rad = 0.0;               ///< 0 when unknown
  std::array<double, 6> covariance{};  ///< of (x, y, yaw): xx xy xyaw yy yyaw yawyaw
};

}  // namespace orchard::pose
