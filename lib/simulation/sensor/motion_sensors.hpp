// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pose/measurements.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/wheeled_body.hpp"
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
/// and noise, along the ground. The covariance states both. Lifted wheels stand still. Leaves utime
/// and seq 0.
pose::Odometry simulate_odometry(const DrivePath& path, double time_s, double period_s,
                                 const OdometryErrors& errors, const MotionConfig& config,
                                 const WheelsConfig& wheels, Random& random,
                                 const WheeledBody& body = {});

/// Simulates a GNSS fix of a point in map, which is east-north-up about `datum`, with noise of sd_m
/// (twice that upwards). Covariance and quality state stated_sd_m. Leaves utime and seq 0.
pose::Gnss simulate_gnss(double x_m, double y_m, const std::array<double, 3>& datum, double sd_m,
                         double stated_sd_m, Random& random, double z_m = 0.0);

/// Simulates an external pose measurement. Leaves utime and seq 0.
pose::PoseFix simulate_fix(const Pose2& T_map_base, double sd_m, double yaw_sd_rad, Random& random);

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

/// An IMU fixed to base with the axes of base.
class InertialUnit {
 public:
  InertialUnit() = default;
  InertialUnit(std::uint64_t seed, const ImuConfig& config, double duration_s,
               bool is_level = true);

  /// Sample `index` of a body on a path, taken at a time of the run [s]. Leaves utime and seq 0.
  pose::Imu sample(const DrivePath& path, std::int64_t index, double time_s,
                   const WheeledBody& body = {}) const;

  /// Bias of the yaw rate at a time, without noise [rad/s].
  double yaw_rate_bias_radps(double time_s) const;

 private:
  std::uint64_t seed_ = 0;
  ImuConfig config_;
  double acceleration_bias_mps2_[2] = {0.0, 0.0};
  double tilt_rate_bias_radps_[2] = {0.0, 0.0};  ///< about x and y; 0 on level ground
  double yaw_bias_rad_ = 0.0;
  std::vector<double> bias_radps_;  ///< one value per second
  std::vector<double> roll_drift_rad_, pitch_drift_rad_;
};

/// Time-correlated effects on a GNSS receiver: gaps and bursts of fixes, a slowly varying error,
/// multipath. Drawn once for a day, which then repeats.
class ReceiverSky {
 public:
  ReceiverSky() = default;
  ReceiverSky(std::uint64_t seed, const SkyConfig& config);

  /// True if fixes are available at a time of the run [s].
  bool is_open(double time_s) const;

  /// Error of a fix, east, north and up, without its own noise [m]; multipath has none upwards.
  Eigen::Vector3d error_m(double time_s) const;

  /// True during multipath.
  bool is_reflected(double time_s) const;

  /// Standard deviation of the slowly varying error, east and north; twice that upwards [m].
  double wander_sd_m() const { return config_.wander_sd_m; }

 private:
  struct Episode {
    double begin_s;
    double end_s;
    Eigen::Vector2d offset_m;
  };

  static const Episode* at(const std::vector<Episode>& episodes, double time_s);
  template <class Length, class Offset>
  static std::vector<Episode> draw_episodes(std::uint64_t seed, std::uint64_t part,
                                            double between_s, Length length_s, Offset offset_m);

  SkyConfig config_;
  std::vector<Episode> gaps_;
  std::vector<Episode> pauses_;
  std::vector<Episode> reflections_;
  std::vector<Eigen::Vector3d> wander_;  ///< at equal steps, in standard deviations
};

/// A GNSS receiver on a driving robot with all effects of section `simulation.gnss`.
class SatelliteReceiver {
 public:
  SatelliteReceiver() = default;
  SatelliteReceiver(std::uint64_t seed, const SimulationConfig& config);

  /// Fix `index`, due at a time of the run [s], with the robot on `path`; none without sky view.
  /// Leaves utime and seq 0.
  std::optional<pose::Gnss> fix(const DrivePath& path, std::int64_t index, double time_s,
                                const WheeledBody& body = {}) const;

 private:
  std::uint64_t seed_ = 0;
  ReceiverConfig config_;
  MotionConfig motion_;
  ReceiverSky sky_;
};

}  // namespace orchard::simulation
