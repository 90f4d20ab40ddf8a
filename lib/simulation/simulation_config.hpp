// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "simulation/scene/board_scene_config.hpp"
#include "simulation/scene/change_config.hpp"
#include "simulation/scene/clutter_config.hpp"
#include "simulation/scene/drive_config.hpp"
#include "simulation/scene/park/park_config.hpp"
#include "simulation/scene/yard/yard_config.hpp"
#include "simulation/sensor/light_config.hpp"

namespace orchard::simulation {

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

/// The paper's simulated environment. Section `simulation.tubes`.
struct TubesConfig {
  double tube_spacing_m = 1.0;
  double row_spacing_m = 1.6;
  double jitter_m = 0.04;     ///< max offset of each tube from its nominal position
  double first_tube_m = 3.3;  ///< from the robot's start to the first tubes
  double step_m = 0.4;
  int num_steps = 19;
  double step_period_s = 1.0;     ///< between two pairs
  double fix_sd_m = 0.001;        ///< of the position measured by hand
  double fix_yaw_sd_rad = 0.003;  ///< of the heading measured by hand
};

template <class Visitor>
void describe(Visitor& v, TubesConfig& c) {
  v.number("tube_spacing_m", c.tube_spacing_m, 0.5, 3, "m", "distance between the tubes of a row");
  v.number("row_spacing_m", c.row_spacing_m, 1, 4, "m", "distance between the two rows");
  v.number("step_m", c.step_m, 0.05, 2, "m", "length of a step of the robot");
  v.integer("num_steps", c.num_steps, 1, 1000, "1",
            "number of steps, each with a scan and a picture");
}

/// Scene orchard. Section `simulation.orchard`.
struct OrchardConfig {
  int num_rows = 4;
  int trees_per_row = 15;
  double row_spacing_m = 4.0;
  double tree_spacing_m = 2.0;
  double jitter_m = 0.15;  ///< max offset of a tree from its nominal position
  double missing_fraction = 0.08;
  double trunk_width_m = 0.125;
  double trunk_width_sd_m = 0.012;
  double post_every_m = 10.0;
  double post_width_m = 0.08;
  double wide_post_fraction = 0.25;
  int num_bushes = 6;
  double bark_hue_min_deg = 20.0;  ///< of the trunks; each trunk has its own
  double bark_hue_max_deg = 34.0;
  double bark_saturation_min = 0.30;
  double bark_saturation_max = 0.48;
  double bark_value_min = 0.45;
  double bark_value_max = 0.65;
  bool rough_bark = false;
  double lean_sd_rad = 0.0;
  double stop_every_m = 0.0;
  double weave_radps = 0.0;
  double weave_period_s = 4.0;
  double speed_mps = 1.0;
  double headland_m = 3.0;
  int laps = 0;
  bool start_anywhere = false;  ///< starts anywhere on the lap instead of at the map's origin
  double fix_rate_hz = 10.0;
  double fix_sd_m = 0.015;
  double fix_yaw_sd_rad = 0.005;
};

template <class Visitor>
void describe(Visitor& v, OrchardConfig& c) {
  v.integer("num_rows", c.num_rows, 2, 200, "rows",
            "number of rows along map y; the robot drives between them");
  v.integer("trees_per_row", c.trees_per_row, 1, 1000, "trees", "number of tree places per row");
  v.number("row_spacing_m", c.row_spacing_m, 1.5, 20, "m", "distance between rows");
  v.number("tree_spacing_m", c.tree_spacing_m, 0.3, 20, "m", "distance between the trees of a row");
  v.number("missing_fraction", c.missing_fraction, 0, 1, "1",
           "fraction of the places that are empty");
  v.number("trunk_width_m", c.trunk_width_m, 0.02, 2, "m", "mean trunk width");
  v.number("trunk_width_sd_m", c.trunk_width_sd_m, 0, 0.5, "m",
           "standard deviation of the trunk width");
  v.number("post_every_m", c.post_every_m, 0, 1000, "m",
           "distance between the posts of a row; 0 = no posts");
  v.number("wide_post_fraction", c.wide_post_fraction, 0, 1, "1",
           "fraction of posts as wide as a trunk");
  v.integer("num_bushes", c.num_bushes, 0, 1000, "1", "number of bushes among the trees");
  v.number("bark_hue_min_deg", c.bark_hue_min_deg, 0, 360, "deg", "min hue of a trunk");
  v.number("bark_hue_max_deg", c.bark_hue_max_deg, 0, 360, "deg", "max hue of a trunk");
  v.number("bark_saturation_min", c.bark_saturation_min, 0, 1, "1", "min saturation of a trunk");
  v.number("bark_saturation_max", c.bark_saturation_max, 0, 1, "1", "max saturation of a trunk");
  v.number("bark_value_min", c.bark_value_min, 0, 1, "1", "min value (brightness) of a trunk");
  v.number("bark_value_max", c.bark_value_max, 0, 1, "1", "max value (brightness) of a trunk");
  v.flag("rough_bark", c.rough_bark,
         "bark with bands and patches of moss and grey instead of even streaks");
  v.number("lean_sd_rad", c.lean_sd_rad, 0, 0.3, "rad",
           "standard deviation of the lean of trunks in the pictures");
  v.number("stop_every_m", c.stop_every_m, 0, 10, "m",
           "distance between stops for each scan, picture and fix; 0 = drive without stops");
  v.number("weave_radps", c.weave_radps, 0, 2, "rad/s",
           "max yaw rate of weaving left and right in a row");
  v.number("weave_period_s", c.weave_period_s, 0.5, 60, "s", "period of that weaving");
  v.number("speed_mps", c.speed_mps, 0.05, 10, "m/s", "speed of the robot");
  v.number("headland_m", c.headland_m, 0.5, 50, "m", "distance driven beyond a row before turning");
  v.integer("laps", c.laps, 0, 1000, "1",
            "laps through all alleys and back to the start; 0 = only to the end of the last alley");
  v.flag("start_anywhere", c.start_anywhere, "start at a random position of the lap; needs laps");
  v.number("fix_rate_hz", c.fix_rate_hz, 0, 100, "Hz", "rate of POSE_FIX; 0 = none");
  v.number("fix_yaw_sd_rad", c.fix_yaw_sd_rad, 0, 1, "rad",
           "standard deviation of the yaw of a POSE_FIX");
  v.check(c.bark_hue_min_deg <= c.bark_hue_max_deg, "bark_hue_min_deg",
          "must not be above bark_hue_max_deg");
  v.check(c.bark_saturation_min <= c.bark_saturation_max, "bark_saturation_min",
          "must not be above bark_saturation_max");
  v.check(c.bark_value_min <= c.bark_value_max, "bark_value_min",
          "must not be above bark_value_max");
  v.check(!c.start_anywhere || c.laps > 0, "start_anywhere", "needs laps above 0");
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
  v.section("light", c.light, "sun, sky and shadows in the pictures");
  v.section("camera_response", c.camera_response, "exposure and white balance of the camera");
  v.section("motion", c.motion, "odometry and GNSS of scene orchard");
  v.section("wheels", c.wheels, "errors of the wheel encoders");
  v.section("gnss", c.gnss, "GNSS antenna and errors");
  v.section("imu", c.imu, "IMU of scene orchard");
  v.section("carry", c.carry, "the robot is lifted and put down in another alley");
  v.section("change", c.change, "changes for scene orchard on a later day");
  v.section("board", c.board, "scene board: a chessboard in front of laser and camera");
}

}  // namespace orchard::simulation
