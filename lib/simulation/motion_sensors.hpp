// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/measurements.hpp"
#include "simulation/drive_path.hpp"
#include "simulation/random.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// What the wheels get wrong for a whole run.
struct OdometryErrors {
  double speed_scale = 0.0;  ///< measured = (1 + speed_scale) true
  double yaw_rate_bias_radps = 0.0;
};

OdometryErrors draw_odometry_errors(const MotionConfig& config, Random& random);

/// What encoders say at a time: the mean motion since `period_s` ago, with the run's errors and
/// noise. The covariance states both. Leaves utime and seq 0.
pose::Odometry simulate_odometry(const DrivePath& path, double time_s, double period_s,
                                 const OdometryErrors& errors, const MotionConfig& config,
                                 Random& random);

/// A satellite fix of base, with map as east-north-up about the datum. Leaves utime and seq 0.
pose::Gnss simulate_gnss(const Pose2& T_map_base, const MotionConfig& config, Random& random);

/// A position measured from outside. Leaves utime and seq 0.
pose::PoseFix simulate_fix(const Pose2& T_map_base, double sd_m, double yaw_sd_rad, Random& random);

}  // namespace orchard::simulation
