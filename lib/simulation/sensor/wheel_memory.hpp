// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/scene/drive_config.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/sensor/motion_sensors.hpp"

namespace orchard::simulation {

/// Errors of wheels that last: slip that belongs to the ground (the same wherever the robot comes
/// by again), a scale that changes with the load, a bias of the yaw rate that wanders.
class WheelMemory {
 public:
  WheelMemory() = default;
  WheelMemory(std::uint64_t seed, const WheelsConfig& config, double duration_s);

  /// The run's errors with those of a time and a place; unchanged where nothing lasts.
  OdometryErrors errors_at(const OdometryErrors& run, double time_s, const Pose2& T_map_base) const;

 private:
  double ground(std::uint64_t layer, double x_m, double y_m) const;

  std::uint64_t seed_ = 0;
  WheelsConfig config_;
  std::vector<double> bias_radps_;  ///< every second
};

}  // namespace orchard::simulation
