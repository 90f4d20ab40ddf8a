// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/scene/drive_config.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/sensor/motion_sensors.hpp"

namespace orchard::simulation {

/// Time-correlated wheel errors: slip that depends on the ground (equal on every pass), a scale
/// that changes with the load, a slowly varying bias of the yaw rate.
class WheelErrorModel {
 public:
  WheelErrorModel() = default;
  WheelErrorModel(std::uint64_t seed, const WheelsConfig& config, double duration_s);

  /// The run's errors plus those of a time and place; unchanged if none are configured.
  OdometryErrors errors_at(const OdometryErrors& run, double time_s, const Pose2& T_map_base) const;

 private:
  double ground(std::uint64_t layer, double x_m, double y_m) const;

  std::uint64_t seed_ = 0;
  WheelsConfig config_;
  std::vector<double> bias_radps_;  ///< one value per second
};

}  // namespace orchard::simulation
