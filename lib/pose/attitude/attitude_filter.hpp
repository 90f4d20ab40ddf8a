// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

#include "pose/attitude/attitude.hpp"
#include "pose/measurements.hpp"

namespace orchard::pose {

/// Estimates the tilt of base from an inertial unit: its rates, held by the direction of gravity in
/// the specific force; or the roll and pitch that it states, if it measures no force or states them
/// to be better than a small unit's forces can tell (0.3 degrees).
///
/// The wheels tell the robot's own acceleration, which is taken out of the specific force. The
/// force is compared in means of a second, whose scatter tells its noise: shaking and what the
/// wheels do not tell included. Without wheels, or once they are silent for a second, the speed is
/// unknown: while the robot turns, the force across it is believed only as far as the speed is
/// known.
class AttitudeFilter {
 public:
  AttitudeFilter();

  /// Takes samples in order of time; earlier ones are ignored.
  void add(const Imu& imu);
  void add(const Odometry& odometry);

  /// The tilt at a time: between the two samples about it, or the newest if that is at most
  /// kFresh_us older. None without a sample near it.
  std::optional<Attitude> at(std::int64_t utime) const;

  /// Rate of the heading [rad/s] by the newest sample.
  double heading_rate_radps() const { return heading_rate_radps_; }

  /// physical: what a robot on wheels tilts in this time is less than data sheets of inertial units
  /// state as their error, and even slow units sample five times in it.
  static constexpr std::int64_t kFresh_us = 200'000;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  /// derived: the order of the state: roll, pitch, three biases, speed.
  static constexpr Eigen::Index kBiases = 2, kSpeed = 5;
  struct Sample {
    std::int64_t utime;
    Attitude attitude;
  };

  Attitude estimated(const Imu& imu);
  void set_speed(double speed_mps, double variance_m2ps2);
  bool has_wheels(std::int64_t utime) const;
  void start(const Imu& imu);
  void predict(const Imu& imu, double time_s);
  void gather(const Imu& imu, double time_s);
  void correct();
  Eigen::Vector2d gravity_xy_mps2() const;
  double sd_rad() const;

  std::deque<Sample> samples_;  ///< of the last second and a half
  double heading_rate_radps_ = 0.0;

  // By rates and forces: roll, pitch, the biases of the rates, the speed along x.
  Vector6 state_ = Vector6::Zero();
  Matrix6 covariance_ = Matrix6::Zero();
  std::optional<Odometry> odometry_;
  double acceleration_mps2_ = 0.0;  ///< along x, by the newest two odometries
  Eigen::Vector2d innovation_mps2_ = Eigen::Vector2d::Zero();  ///< sum of a mean
  double turned_radps_ = 0.0;                                  ///< sum of a mean, about z
  double gathered_s_ = 0.0;
  int num_gathered_ = 0;
  double force_variance_;  ///< of a mean [m2/s4]
  int num_means_ = 0;
};

}  // namespace orchard::pose
