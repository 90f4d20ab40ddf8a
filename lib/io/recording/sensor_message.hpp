// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "laser/scan.hpp"
#include "pose/measurements.hpp"
#include "vision/image.hpp"

namespace orchard::io {

/// A message of a recording; messages of equal time are ordered by alternative.
using SensorMessage = std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss,
                                   pose::PoseFix, pose::Imu, laser::RearScan>;

inline std::int64_t utime_of(const SensorMessage& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

/// Pose of a sensor on the robot, T_base_sensor in the plane, as given in the recording.
struct SensorMount {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// Sorts messages by (utime, alternative) and numbers each kind from 0.
void sort_and_number(std::vector<SensorMessage>& messages);

}  // namespace orchard::io
