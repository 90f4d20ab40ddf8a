// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pose/measurements.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Constant odometry errors of a run.
struct OdometryErrors {
  double speed_scale = 0.0;  ///< measured = (1 + speed_scale) true
  double yaw_rate_bias_radps = 0.0;
  double yaw_rate_scale = 0.0;  ///< measured = (1 + yaw_rate_scale) true
};

OdometryErrors draw_odometry_errors(const MotionConfig& config, const WheelsConfig& wheels,
                                    Random& random);

/// Simulates ODOMETRY at a time: the mean motion over the last `period_s`, with the run's errors
/// and noise. The covariance states both. Slipping wheels turn more than the robot in curves;
/// lifted wheels stand still. Leaves utime and seq 0.
pose::Odometry simulate_odometry(const DrivePath& path, double time_s, double period_s,
                                 const OdometryErrors& errors, const MotionConfig& config,
                                 const WheelsConfig& wheels, double turn_slip, Random& random);

/// Simulates a GNSS fix of a point in map, which is east-north-up about `datum`, with noise of sd_m
/// (twice that upwards). Covariance and quality state stated_sd_m. Leaves utime and seq 0.
pose::Gnss simulate_gnss(double x_m, double y_m, const std::array<double, 3>& datum, double sd_m,
                         double stated_sd_m, Random& random);

/// Simulates an external pose measurement. Leaves utime and seq 0.
pose::PoseFix simulate_fix(const Pose2& T_map_base, double sd_m, double yaw_sd_rad, Random& random);

}  // namespace orchard::simulation
