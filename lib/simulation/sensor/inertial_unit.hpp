// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pose/measurements.hpp"
#include "simulation/scene/drive_config.hpp"
#include "simulation/scene/drive_path.hpp"

namespace orchard::simulation {

/// An IMU fixed to base with the axes of base, on level ground.
class InertialUnit {
 public:
  InertialUnit() = default;
  InertialUnit(std::uint64_t seed, const ImuConfig& config, double duration_s);

  /// Sample `index`, taken at a time of the run [s]. Leaves utime and seq 0.
  pose::Imu sample(const DrivePath& path, std::int64_t index, double time_s) const;

  /// Bias of the yaw rate at a time, without noise [rad/s].
  double yaw_rate_bias_radps(double time_s) const;

 private:
  std::uint64_t seed_ = 0;
  ImuConfig config_;
  double acceleration_bias_mps2_[2] = {0.0, 0.0};
  double yaw_bias_rad_ = 0.0;
  std::vector<double> bias_radps_;  ///< every kWalkStep_s, linearly interpolated
};

}  // namespace orchard::simulation
