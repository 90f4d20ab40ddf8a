// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"
#include "simulation/scene/scene_config.hpp"

namespace orchard::simulation {

/// The light in a picture. Section `simulation.light`. Disabled: simple shading.
struct LightConfig {
  bool enabled = false;
  bool sun_from_seed = true;
  double sun_azimuth_deg = 0.0;
  double sun_elevation_deg = 40.0;
  double sun_fraction = 0.75;
  bool shadows = true;
  double temperature_k = 5500.0;
  double shade_temperature_ratio = 1;
  double drift_ev_per_min = 0.0;
  double drift_ev_amplitude = 0.0;
  double drift_k_amplitude = 0.0;
  double drift_period_s = 120.0;
};

template <class Visitor>
void describe(Visitor& v, LightConfig& c) {
  v.flag("enabled", c.enabled,
         "simulate sun, sky and shadows in linear light; needed by the keys below");
  v.flag("sun_from_seed", c.sun_from_seed, "the seed chooses the direction of the sun");
  v.number("sun_azimuth_deg", c.sun_azimuth_deg, -360, 360, "deg",
           "azimuth of the sun, from map x towards y");
  v.number("sun_elevation_deg", c.sun_elevation_deg, 3, 90, "deg",
           "elevation of the sun above the horizon");
  v.number("sun_fraction", c.sun_fraction, 0, 1, "1",
           "fraction of the light that comes directly from the sun");
  v.flag("shadows", c.shadows, "shadows of objects, dappled under crowns");
  v.number("temperature_k", c.temperature_k, 1500, 15000, "K", "colour temperature of the sun");
  v.number("shade_temperature_ratio", c.shade_temperature_ratio, 0.5, 4, "1",
           "ratio of the colour temperatures of sky and sun");
  v.number("drift_ev_amplitude", c.drift_ev_amplitude, 0, 4, "EV",
           "amplitude of a sine of that brightness");
  v.number("drift_k_amplitude", c.drift_k_amplitude, 0, 5000, "K",
           "amplitude of a sine of the colour temperature");
  v.number("drift_period_s", c.drift_period_s, 1, 1e5, "s", "period of both sines");
}

/// Response of the camera to light. Section `simulation.camera_response`; takes effect when
/// `simulation.light.enabled`.
struct CameraResponseConfig {
  double exposure_ev = 0.0;
  double white_balance_k = 5500.0;
  double auto_exposure = 0.0;
  double auto_exposure_lag_s = 0.5;
  double vignetting = 0.0;
  double gamma = 2.2;
  double exposure_s = 0.0;
};

template <class Visitor>
void describe(Visitor& v, CameraResponseConfig& c) {
  v.number("exposure_ev", c.exposure_ev, -6, 6, "EV",
           "exposure; 0: white in full sun is full scale");
  v.number("white_balance_k", c.white_balance_k, 1500, 15000, "K",
           "colour temperature that appears neutral");
  v.number("auto_exposure", c.auto_exposure, 0, 1, "1",
           "fraction of the drift of the light that the exposure compensates");
  v.number("auto_exposure_lag_s", c.auto_exposure_lag_s, 0, 60, "s",
           "time constant of that compensation");
  v.number("vignetting", c.vignetting, 0, 1, "1", "fraction of light lost in the corners");
  v.number("exposure_s", c.exposure_s, 0, 0.1, "s",
           "exposure time, for motion blur while turning; 0 = sharp");
}

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
           "standard deviation of the slowly changing error, east and north; twice that upwards");
  v.number("gap_every_s", c.gap_every_s, 0, 1e5, "s", "mean time between gaps; 0 = no gaps");
  v.number("burst_s", c.burst_s, 0, 1e4, "s", "mean length of a burst of fixes; 0 = no bursts");
  v.number("pause_s", c.pause_s, 0, 1e4, "s", "mean length of the pause after a burst");
  v.number("multipath_fraction", c.multipath_fraction, 0, 0.9, "1",
           "fraction of the time with multipath");
}

/// Antenna position and errors of the GNSS receiver. Section `simulation.gnss`.
struct ReceiverConfig {
  std::array<double, 2> antenna_m{0.0, 0.0};  ///< in base
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
  double attitude_drift_sd_rad = 0.0;
  double attitude_drift_s = 30.0;  ///< time constant of that error
  double vibration_sd_mps2 = 0.0;
};

template <class Visitor>
void describe(Visitor& v, ImuConfig& c) {
  v.number("rate_hz", c.rate_hz, 0, 1000, "Hz", "rate of IMU; 0 = none");
  v.flag("orientation", c.orientation, "the IMU states roll, pitch, and yaw from east");
  v.number("attitude_drift_sd_rad", c.attitude_drift_sd_rad, 0, 0.5, "rad",
           "standard deviation of the slowly changing error of roll and pitch");
  v.number("vibration_sd_mps2", c.vibration_sd_mps2, 0, 50, "m/s2",
           "standard deviation of the vibration in the specific force, per axis");
}

/// The simulated scanner; the defaults are those of a Hokuyo URG-04LX-UG01. Section
/// `simulation.scanner`.
///
/// Its data sheet's +-3 % (+-30 mm below 1 m) is a limit over all targets, temperatures and units,
/// not a standard deviation. It is modelled as the sum of three errors, clipped at the limit: one
/// per beam; one per target and scan, which moves a whole trunk and causes the SE of eq. 13; and a
/// constant one per target, due to its surface, a bias that no SE shows.
struct ScannerConfig {
  int num_beams = 683;
  double bearing_min_rad = -2.0923497946760149;     ///< -341 steps
  double bearing_step_rad = 0.0061359231515425649;  ///< 360/1024 deg
  double range_min_m = 0.02;
  double range_max_m = 5.6;
  double rate_hz = 10.0;
  double beam_period_us = 97.65625;  ///< 100 ms / 1024
  double spot_rad = 0.004;
  double spot_m = 0.0;
  double return_fraction = 0.5;
  double bloom_rad = 0.0;
  double mixed_probability = 0.5;
  double dropout_probability = 0.0005;
  double beam_sd_m = 0.003;
  double beam_sd_fraction = 0.003;
  double scan_sd_fraction = 0.004;
  double target_sd_fraction = 0.002;
  double limit_fraction = 0.03;
  double limit_m = 0.03;
  double resolution_m = 0.001;
  double height_m = 0.27;
  bool intensities = false;
  double tilt_sd_rad = 0.0;
};

template <class Visitor>
void describe(Visitor& v, ScannerConfig& c) {
  v.integer("num_beams", c.num_beams, 2, 20000, "beams", "number of beams of a scan");
  v.number("bearing_min_rad", c.bearing_min_rad, -6.2832, 6.2832, "rad",
           "bearing of the first beam");
  v.number("bearing_step_rad", c.bearing_step_rad, 1e-5, 0.2, "rad", "angle between two beams");
  v.number("range_min_m", c.range_min_m, 0, 10, "m", "min range");
  v.number("range_max_m", c.range_max_m, 0.1, 300, "m", "max range");
  v.number("rate_hz", c.rate_hz, 0.1, 100, "Hz", "scans per second while driving");
  v.number("beam_period_us", c.beam_period_us, 0, 10000, "us", "time between two beams");
  v.number("spot_rad", c.spot_rad, 0, 0.05, "rad", "divergence of the beam");
  v.number("spot_m", c.spot_m, 0, 0.2, "m", "width of the laser spot at the scanner");
  v.number(
      "return_fraction", c.return_fraction, 0.01, 0.5, "1",
      "min fraction of a spot on an object for a return: 0.5 for a line, less for real scanners");
  v.number("bloom_rad", c.bloom_rad, 0, 0.05, "rad",
           "angle by which a reflector extends into neighbouring beams");
  v.number("mixed_probability", c.mixed_probability, 0, 1, "1",
           "probability of a range between two surfaces that share a spot");
  v.number("dropout_probability", c.dropout_probability, 0, 1, "1",
           "probability that a hit gives no return");
  v.number("beam_sd_m", c.beam_sd_m, 0, 1, "m", "standard deviation of each range, constant part");
  v.number("beam_sd_fraction", c.beam_sd_fraction, 0, 0.2, "1",
           "standard deviation of each range, per metre");
  v.number("scan_sd_fraction", c.scan_sd_fraction, 0, 0.2, "1",
           "standard deviation of the range error of an object in a scan, per metre");
  v.number("target_sd_fraction", c.target_sd_fraction, 0, 0.2, "1",
           "standard deviation of the constant range error of an object, per metre");
  v.number("limit_fraction", c.limit_fraction, 0, 0.5, "1",
           "limit of the range error from 1 m on, as a fraction of the range");
  v.number("limit_m", c.limit_m, 0, 1, "m", "limit of the range error below 1 m");
  v.number("resolution_m", c.resolution_m, 1e-6, 0.1, "m", "resolution of the ranges");
  v.number("height_m", c.height_m, 0.02, 5, "m", "height of the scan plane above the ground");
  v.flag("intensities", c.intensities, "SCAN states intensities");
  v.number("tilt_sd_rad", c.tilt_sd_rad, 0, 0.3, "rad",
           "standard deviation of pitch and roll of a scan on uneven ground");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

/// Image acquisition. Section `simulation.image`; optics and extrinsics are in section `camera`.
struct ImageConfig {
  double rate_hz = 10.0;
  double offset_s = 0.035;
  double noise_sd = 2.5;  ///< of every pixel and channel
  double blur_px = 0.6;   ///< sigma of lens and sensor
  int jpeg_quality = 88;
  double stamp_delay_s = 0.0;
};

template <class Visitor>
void describe(Visitor& v, ImageConfig& c) {
  v.number("rate_hz", c.rate_hz, 0.1, 100, "Hz", "pictures per second while driving");
  v.number("offset_s", c.offset_s, 0, 1, "s", "time from a scan to its picture while driving");
  v.number("stamp_delay_s", c.stamp_delay_s, -0.5, 0.5, "s",
           "delay of the time stamp of a picture after its exposure");
}

/// Odometry and GNSS while driving. Section `simulation.motion`.
struct MotionConfig {
  double odometry_rate_hz = 50.0;
  double speed_scale_sd = 0.01;
  double speed_sd_mps = 0.01;
  double yaw_rate_bias_sd_radps = 0.001;
  double yaw_rate_sd_radps = 0.01;
  double gnss_rate_hz = 5.0;
  double gnss_sd_m = 0.02;  ///< east and north; twice that upwards
  std::array<double, 3> datum{-27.6040, 151.9320, 690.0};
};

template <class Visitor>
void describe(Visitor& v, MotionConfig& c) {
  v.number("odometry_rate_hz", c.odometry_rate_hz, 0, 1000, "Hz", "rate of ODOMETRY; 0 = none");
  v.number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
           "standard deviation of the scale error of speed, per run");
  v.number("speed_sd_mps", c.speed_sd_mps, 0, 5, "m/s", "standard deviation of the noise of speed");
  v.number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
           "standard deviation of the bias of the yaw rate, per run");
  v.number("yaw_rate_sd_radps", c.yaw_rate_sd_radps, 0, 3, "rad/s",
           "standard deviation of the noise of the yaw rate");
  v.number("gnss_rate_hz", c.gnss_rate_hz, 0, 100, "Hz", "rate of GNSS; 0 = none");
  v.number("gnss_sd_m", c.gnss_sd_m, 0, 100, "m", "standard deviation of GNSS, east and north");
  v.numbers("datum", c.datum, -1000, 10000, "deg, deg, m",
            "latitude, longitude, altitude of the origin of the map");
  v.check(c.datum[0] > -90 && c.datum[0] < 90, "datum", "latitude must be in (-90, 90)");
  v.check(c.datum[1] >= -180 && c.datum[1] <= 180, "datum", "longitude must be in [-180, 180]");
}

/// Configuration of the simulated world and sensors. Section `simulation`.
struct SimulationConfig {
  ScannerConfig scanner;
  ImageConfig image;
  TubesConfig tubes;
  OrchardConfig orchard;
  ParkConfig park;
  YardConfig yard;
  ClutterConfig clutter;
  TerrainConfig terrain;
  LightConfig light;
  CameraResponseConfig camera_response;
  MotionConfig motion;
  WheelsConfig wheels;
  ReceiverConfig gnss;
  ImuConfig imu;
  CarryConfig carry;
  ChangeConfig change;
  BoardSceneConfig board;
};

template <class Visitor>
void describe(Visitor& v, SimulationConfig& c) {
  v.section("scanner", c.scanner, "laser scanner");
  v.section("image", c.image, "camera");
  v.section("tubes", c.tubes, "scene tubes: the paper's simulated environment");
  v.section("orchard", c.orchard, "scene orchard");
  v.section("park", c.park, "scene park: scattered trees, driven through by a car");
  v.section("yard", c.yard, "scene yard: a building, a shed, hedges, scattered trees");
  v.section("clutter", c.clutter, "other fixed and moving objects of scene orchard");
  v.section("terrain", c.terrain, "slopes, bumps, grass; all zero: level ground");
  v.section("light", c.light, "sun, sky and shadows in the pictures");
  v.section("camera_response", c.camera_response, "exposure and white balance of the camera");
  v.section("motion", c.motion, "odometry and GNSS of scene orchard");
  v.section("wheels", c.wheels, "errors of the wheel encoders");
  v.section("gnss", c.gnss, "GNSS antenna and errors");
  v.section("imu", c.imu, "IMU of scene orchard");
  v.section("carry", c.carry, "the robot is lifted and put down in another aisle");
  v.section("change", c.change, "changes for scene orchard on a later day");
  v.section("board", c.board, "scene board: a chessboard in front of laser and camera");
}

/// The parts of a rig's configuration that the simulation needs.
struct RigConfig {
  laser::LaserConfig laser;
  geometry::CameraConfig camera;
  SimulationConfig simulation;
  laser::RearLaserConfig laser_rear;  ///< the rear scanner; measures with the same errors
};

}  // namespace orchard::simulation
