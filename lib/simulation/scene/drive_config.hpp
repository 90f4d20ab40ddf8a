// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace orchard::simulation {

/// Time of an event: once or periodic. Off when its duration is 0.
struct EpisodeConfig {
  double at_s = 0.0;
  double for_s = 0.0;
  double every_s = 0.0;

  /// Index of the occurrence at a time of the run, from 0; -1: none.
  int number_at(double time_s) const {
    if (for_s <= 0.0 || time_s < at_s) return -1;
    const int number = every_s > 0.0 ? static_cast<int>((time_s - at_s) / every_s) : 0;
    return time_s - begin_s(number) < for_s ? number : -1;
  }
  double begin_s(int number) const { return at_s + number * every_s; }
};

template <class Visitor>
void describe(Visitor& v, EpisodeConfig& c) {
  v.number("at_s", c.at_s, 0, 1e6, "s", "time of the first event, from the start");
  v.number("for_s", c.for_s, 0, 1e6, "s", "duration of an event; 0 = no events");
  v.number("every_s", c.every_s, 0, 1e6, "s", "interval of events; 0 = one event");
}

/// Errors of wheel encoders beyond section `motion`. Section `simulation.wheels`.
struct WheelsConfig {
  double yaw_rate_scale_sd = 0.0;
  double turn_slip_sd = 0.0;  ///< scale error of speed and yaw rate in each curve
  EpisodeConfig outage;
  double surface_slip_sd = 0.0;
  double surface_turn_slip_sd = 0.0;
  double surface_m = 15.0;  ///< size of a patch of ground
  double load_sd = 0.0;
  double load_every_s = 400.0;  ///< from one change of the load to the next
  double bias_wander_sd_radps = 0.0;
  double bias_wander_s = 60.0;  ///< time constant of that bias
  bool states_covariance = true;
};

template <class Visitor>
void describe(Visitor& v, WheelsConfig& c) {
  v.number("yaw_rate_scale_sd", c.yaw_rate_scale_sd, 0, 0.5, "1",
           "standard deviation of the scale error of the yaw rate, per run");
  v.section("outage", c.outage, "periods without ODOMETRY");
  v.number("surface_slip_sd", c.surface_slip_sd, 0, 0.5, "1",
           "standard deviation of the scale error of speed, which depends on the ground");
  v.number("surface_turn_slip_sd", c.surface_turn_slip_sd, 0, 0.5, "1",
           "standard deviation of the scale error of yaw rate, which depends on the ground");
  v.number("load_sd", c.load_sd, 0, 0.5, "1",
           "standard deviation of the scale error of speed, which depends on the load");
  v.number("bias_wander_sd_radps", c.bias_wander_sd_radps, 0, 1, "rad/s",
           "standard deviation of the wandering bias of the yaw rate");
  v.flag("states_covariance", c.states_covariance, "ODOMETRY states its covariance");
}

/// Time-correlated errors and availability of a GNSS receiver. Section `simulation.gnss.sky`.
struct SkyConfig {
  double wander_sd_m = 0.0;
  double wander_time_s = 60.0;  ///< its correlation time (to 1/e)
  double gap_every_s = 0.0;
  double gap_min_s = 20.0;   ///< min gap; lengths are uniform in their logarithm
  double gap_max_s = 180.0;  ///< max gap
  double burst_s = 0.0;
  double pause_s = 0.0;
  double multipath_fraction = 0.0;
  double multipath_for_s = 8.0;  ///< mean duration of a reflection
  double multipath_m = 10.0;     ///< mean length of its error, which is constant meanwhile
};

template <class Visitor>
void describe(Visitor& v, SkyConfig& c) {
  v.number("wander_sd_m", c.wander_sd_m, 0, 100, "m",
           "standard deviation of the slowly changing error, per axis");
  v.number("gap_every_s", c.gap_every_s, 0, 1e5, "s", "mean time between gaps; 0 = no gaps");
  v.number("burst_s", c.burst_s, 0, 1e4, "s", "mean length of a burst of fixes; 0 = no bursts");
  v.number("pause_s", c.pause_s, 0, 1e4, "s", "mean length of the pause after a burst");
  v.number("multipath_fraction", c.multipath_fraction, 0, 0.9, "1",
           "fraction of the time with multipath");
}

/// Antenna position and errors of the GNSS receiver. Section `simulation.gnss`.
struct ReceiverConfig {
  std::array<double, 2> antenna_m{0.0, 0.0};  ///< in base
  double canopy_fraction = 0.0;               ///< fraction of the alley segments without sky view
  double canopy_length_m = 10.0;              ///< length of a segment
  double canopy_sd_m = 0.0;                   ///< noise there, stated correctly; 0: no fix
  double stated_sd_m = 0.0;
  EpisodeConfig outage;
  double jump_m = 30.0;
  EpisodeConfig jump;
  EpisodeConfig freeze;  ///< repeats the same position
  SkyConfig sky;
};

template <class Visitor>
void describe(Visitor& v, ReceiverConfig& c) {
  v.number("stated_sd_m", c.stated_sd_m, 0, 100, "m",
           "standard deviation that fixes state; 0 = the true one");
  v.section("outage", c.outage, "periods without GNSS");
  v.number("jump_m", c.jump_m, 0, 1e5, "m", "offset of fixes during a jump");
  v.section("jump", c.jump, "periods with displaced fixes, each time in another direction");
  v.section("freeze", c.freeze, "periods with a frozen position");
  v.section("sky", c.sky, "correlated errors, bursts and gaps of fixes");
}

/// An IMU on base; the defaults are those of a small MEMS unit. Section `simulation.imu`.
struct ImuConfig {
  double rate_hz = 0.0;
  double angular_rate_sd_radps = 0.002;     ///< of each sample and axis
  double yaw_rate_bias_sd_radps = 0.003;    ///< of the initial bias, per run
  double yaw_rate_walk = 3e-5;              ///< random walk of the bias [rad/s/sqrt(s)]
  double acceleration_sd_mps2 = 0.05;       ///< of each sample and axis
  double acceleration_bias_sd_mps2 = 0.05;  ///< of the bias forward and left, per run
  bool orientation = false;
  double orientation_sd_rad = 0.01;  ///< of each sample
  double yaw_bias_sd_rad = 0.03;     ///< of the error of north, per run
};

template <class Visitor>
void describe(Visitor& v, ImuConfig& c) {
  v.number("rate_hz", c.rate_hz, 0, 1000, "Hz", "rate of IMU; 0 = none");
  v.flag("orientation", c.orientation, "the IMU states roll, pitch, and yaw from east");
}

/// The robot is lifted over the trees and set down in another alley. Section `simulation.carry`.
struct CarryConfig {
  double at_s = 0.0;
  double for_s = 0.0;
  int to_alley = 0;
  bool odometry = true;
};

template <class Visitor>
void describe(Visitor& v, CarryConfig& c) {
  v.number("at_s", c.at_s, 0, 1e6, "s", "time at which the robot is lifted; 0 = never");
  v.number("for_s", c.for_s, 0, 1e6, "s", "time until it is put down; 0 = never");
  v.integer("to_alley", c.to_alley, 0, 1000, "1",
            "alley in which it is put down, from 1; 0 = any other alley");
  v.flag("odometry", c.odometry, "ODOMETRY continues meanwhile, with standing wheels");
}

}  // namespace orchard::simulation
