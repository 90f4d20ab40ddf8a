// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "pose/measurements.hpp"

namespace orchard::pose {

/// Configuration of the fusion of ODOMETRY, IMU, GNSS and POSE_FIX. Section `pose.fusion`.
struct FusionConfig {
  bool use_imu = false;
  bool use_gnss = true;
  bool use_fixes = false;
  /// The wheels' lasting errors are estimated. Else each reading errs by itself, by what it states:
  /// what nothing can teach would only widen the gates of the mapping. Not a key: by pose.mode.
  bool learns_wheels = true;
  double speed_scale_sd = 0.05;
  double gyro_sd_radps = 0.005;
};

template <class Visitor>
void describe(Visitor& v, FusionConfig& c) {
  v.flag("use_imu", c.use_imu, "use the yaw rate of the IMU instead of that of the wheels");
  v.flag("use_gnss", c.use_gnss, "use GNSS; see section pose.gnss");
  v.flag("use_fixes", c.use_fixes, "use POSE_FIX");
  v.expert().number(
      "speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
      "prior standard deviation of the wheels' scale error, which is estimated while driving");
  v.expert().number(
      "gyro_sd_radps", c.gyro_sd_radps, 1e-6, 3, "rad/s",
      "standard deviation of the yaw rate of an IMU without variance; from the data sheet");
}

/// Correlation time of a receiver's error (decay to 1/e) [s]. physical: errors of orbits and
/// atmosphere change more slowly, those of multipath within minutes.
inline constexpr double kReceiverMemory_s = 60.0;

/// Configuration of satellite fixes. Section `pose.gnss`.
struct GnssConfig {
  /// Latitude [deg], longitude [deg], altitude [m] of map's origin; map x points east. All 0: the
  /// first usable fix.
  std::array<double, 3> datum{0.0, 0.0, 0.0};
  std::array<double, 2> antenna_m{0.0, 0.0};
  double antenna_height_m = 0.0;  ///< above the ground
  // Min standard deviation of a fix, by its quality, whatever the receiver claims. physical: what
  // data sheets of receivers state.
  static constexpr double kSdFixed_m = 0.015;
  static constexpr double kSdFloat_m = 0.30;
  static constexpr double kSdDifferential_m = 0.60;
  static constexpr double kSdSingle_m = 1.5;
};

template <class Visitor>
void describe(Visitor& v, GnssConfig& c) {
  v.numbers(
      "datum", c.datum, -1000, 10000, "deg, deg, m",
      "latitude, longitude, altitude of the origin of the map; 0, 0, 0 = the first valid fix");
  v.numbers("antenna_m", c.antenna_m, -20, 20, "m",
            "x, y of the antenna in base, measured with a ruler");
  v.number("antenna_height_m", c.antenna_height_m, 0, 20, "m",
           "height of the antenna above the ground, by which the heights of the map are too high "
           "if it is not told");
  v.check(c.datum[0] > -90 && c.datum[0] < 90, "datum", "latitude must be in (-90, 90)");
  v.check(c.datum[1] >= -180 && c.datum[1] <= 180, "datum", "longitude must be in [-180, 180]");
}

/// Knowledge of the pose at the start.
enum class PriorStart {
  kGlobal,  ///< none: global localisation by the trunks
  kGiven,   ///< start_x_m, start_y_m, start_yaw_rad
};

/// Configuration of localisation in the map of an earlier day. Section `pose.prior_map`.
struct PriorMapConfig {
  std::string map_file;
  PriorStart start = PriorStart::kGlobal;
  double start_x_m = 0.0;
  double start_y_m = 0.0;
  double start_yaw_rad = 0.0;
  // physical: how well a person tells where a robot stands.
  static constexpr double kStartPositionSd_m = 0.3;
  static constexpr double kStartYawSd_rad = 0.1;

  int min_observations = 2;
  double survey_sd_m = 0.1;
  static constexpr double kLandmarkSd_m = 0.05;  ///< to its neighbours; physical: bark, growth
  double width_sd_m = 0.01;
  double observation_sd_m = 0.02;
  double observation_range_max_m = 10.0;
  double detection_range_m = 4.0;

  double speed_scale_sd = 0.03;
  double turn_scale_sd = 0.03;
  double yaw_rate_bias_sd_radps = 0.005;

  double window_m = 15.0;
};

template <class Visitor>
void describe(Visitor& v, PriorMapConfig& c) {
  v.text("map_file", c.map_file,
         "map.csv of an earlier drive, or its folder; or a survey of trunks and posts as points "
         "(CSV, GeoJSON ...)");
  v.number("survey_sd_m", c.survey_sd_m, 0.001, 5, "m",
           "standard deviation of the place of a surveyed trunk where the laser sees it, if the "
           "survey does not state it (column sd_m)");
  v.expert().choice("start", c.start, {"global", "given"},
                    "start pose: found by recognising the trunks, or given by start_x_m, "
                    "start_y_m, start_yaw_rad");
  v.expert().number("start_x_m", c.start_x_m, -1e8, 1e8, "m",
                    "start: given: x of base in the prior map");
  v.expert().number("start_y_m", c.start_y_m, -1e8, 1e8, "m",
                    "start: given: y of base in the prior map");
  v.expert().number("start_yaw_rad", c.start_yaw_rad, -6.2832, 6.2832, "rad",
                    "start: given: yaw of base in the prior map");
  v.expert().integer("min_observations", c.min_observations, 0, 1000000, "1",
                     "min observations of a landmark of the prior map to be used");
  v.expert().number(
      "width_sd_m", c.width_sd_m, 0.001, 1, "m",
      "standard deviation of the change of a trunk's measured width between two days");
  v.expert().number(
      "observation_sd_m", c.observation_sd_m, 0.001, 1, "m",
      "standard deviation of an observed centre, added to the covariance of the detector");
  v.expert().number("observation_range_max_m", c.observation_range_max_m, 0.5, 200, "m",
                    "max range of observations; farther ones are ignored");
  v.expert().number("detection_range_m", c.detection_range_m, 0.5, 200, "m",
                    "range within which trunks that are not occluded are usually detected");
  v.expert().number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
                    "prior standard deviation of the scale of the wheels' speed");
  v.expert().number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1",
                    "prior standard deviation of the scale of the wheels' yaw rate");
  v.expert().number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
                    "prior standard deviation of the bias of the wheels' yaw rate");
  v.expert().number("window_m", c.window_m, 2, 200, "m",
                    "length of the path whose trunks are compared with the map");
  v.check(c.detection_range_m <= c.observation_range_max_m, "detection_range_m",
          "must not be above observation_range_max_m");
}

/// Configuration of the motion estimate by scan matching. Section `pose.scan_motion`.
struct ScanMotionConfig {
  double range_min_m = 0.3;
  double range_max_m = 30.0;
  bool deskew = true;

  double search_shift_m = 0.6;
};

template <class Visitor>
void describe(Visitor& v, ScanMotionConfig& c) {
  v.number("range_min_m", c.range_min_m, 0, 100, "m",
           "nearer returns are ignored (the robot itself)");
  v.number("range_max_m", c.range_max_m, 0.5, 500, "m", "farther returns are ignored");
  v.flag("deskew", c.deskew, "compensate the motion within a scan, if SCAN states its beam period");
  v.number("search_shift_m", c.search_shift_m, 0, 5, "m",
           "search range of the position, to each side of the predicted one");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

/// Configuration of trunk-landmark SLAM. Section `pose.slam`.
struct SlamConfig {
  double detections_wait_s = 0.5;
  double keyframe_travel_m = 0.5;
  int window_keyframes = 30;

  double observation_sd_m = 0.02;
  double observation_range_max_m = 30.0;
  double width_max_m = 1.5;

  double gate_sigma = 3.5;
  double gate_m = 0.6;
  double width_gate_m = 0.15;
  double new_landmark_m = 0.6;
  /// Minimum detection rate per keyframe; rarer detections are clutter.
  double detection_rate_min = 0.0;

  double speed_scale_sd = 0.05;
  double turn_scale_sd = 0.1;
  double yaw_rate_bias_sd_radps = 0.01;

  double gap_s = 0.5;

  double lost_sd_m = 0.8;

  double closure_kernel_m = 0.4;
  double closure_sd_m = 0.04;
  double closure_margin = 8.0;
  bool use_fixes = false;
  bool use_gnss = false;
  double submap_length_m = 8.0;
};

template <class Visitor>
void describe(Visitor& v, SlamConfig& c) {
  v.expert().number("detections_wait_s", c.detections_wait_s, 0, 60, "s",
                    "max delay of DETECTIONS behind the motion (message time)");
  v.expert().number("keyframe_travel_m", c.keyframe_travel_m, 0.05, 10, "m",
                    "distance between keyframes; smaller is more accurate and slower");
  v.expert().integer("window_keyframes", c.window_keyframes, 4, 200, "keyframes",
                     "number of recent keyframes that are optimised at each keyframe");
  v.expert().number(
      "observation_sd_m", c.observation_sd_m, 0.001, 1, "m",
      "standard deviation of an observed centre, added to the covariance of the detector");
  v.expert().number("observation_range_max_m", c.observation_range_max_m, 0.5, 200, "m",
                    "max range of observations; farther ones are ignored");
  v.expert().number("width_max_m", c.width_max_m, 0.05, 10, "m",
                    "max width of a landmark; wider objects are ignored");
  v.expert().number("gate_sigma", c.gate_sigma, 1, 10, "sigma",
                    "gate of data association, in standard deviations");
  v.number("gate_m", c.gate_m, 0.05, 10, "m", "max distance of an observation from its landmark");
  v.expert().number("width_gate_m", c.width_gate_m, 0, 5, "m",
                    "max difference of widths, in addition to their uncertainty");
  v.expert().number("new_landmark_m", c.new_landmark_m, 0.05, 10, "m",
                    "min distance of a new landmark from existing ones");
  v.expert().number("detection_rate_min", c.detection_rate_min, 0, 1, "1",
                    "min fraction of a keyframe's scans that observe a landmark; rarer detections "
                    "are clutter (ground, leaves)");
  v.expert().number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
                    "prior standard deviation of the scale of the wheels' speed");
  v.expert().number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1",
                    "prior standard deviation of the scale of the wheels' yaw rate");
  v.expert().number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
                    "prior standard deviation of the bias of the wheels' yaw rate");
  v.expert().number("gap_s", c.gap_s, 0.01, 60, "s",
                    "a longer interval without measured motion is a gap");
  v.expert().number("lost_sd_m", c.lost_sd_m, 0.1, 20, "m",
                    "position uncertainty (1 sigma) above which trunks are not recognised and a "
                    "new session starts; about a third of their spacing");
  v.expert().number("closure_kernel_m", c.closure_kernel_m, 0.02, 5, "m",
                    "loop closure: max distance of matched landmarks after registration");
  v.expert().number("closure_sd_m", c.closure_sd_m, 0.01, 1, "m",
                    "loop closure: standard deviation of a tree's position within a submap");
  v.expert().number("closure_margin", c.closure_margin, 0, 100, "log-likelihood",
                    "loop closure: min log-likelihood advantage over any other registration; "
                    "larger closes fewer, surer loops");
  v.flag("use_fixes", c.use_fixes, "use POSE_FIX to georeference the map and limit its drift");
  v.flag("use_gnss", c.use_gnss,
         "use GNSS to georeference the map and limit its drift; map x points east, y north from "
         "pose.gnss.datum");
  v.expert().number("submap_length_m", c.submap_length_m, 0.5, 1000, "m",
                    "path length of a submap; large graphs are solved submap by submap");
}

/// Localisation mode.
enum class PoseMode {
  kFixes,             ///< POSE_FIX alone: every fix is a pose
  kFixesAndOdometry,  ///< fixes, with dead reckoning by ODOMETRY in between
  kOdometry,          ///< dead reckoning alone, from the map's origin
  kStationary,        ///< the robot stands at the map's origin
  kFused,             ///< wheels, IMU, GNSS and fixes: sections `pose.fusion` and `pose.gnss`
  kPriorMap,          ///< localisation in the map of an earlier day: section `pose.prior_map`
  kSlam,              ///< SLAM with trunks, from the map's origin: section `pose.slam`
};

/// Source of the robot's relative motion.
enum class MotionSource {
  kWheels,  ///< ODOMETRY
  kScans,   ///< SCAN: each scan is matched to the previous ones, from where ODOMETRY expects it
};

/// Configuration of the localisation. Section `pose`.
struct PoseConfig {
  PoseMode mode = PoseMode::kFixesAndOdometry;
  MotionSource motion = MotionSource::kWheels;
  double reorder_window_s = 0.02;
  double fix_position_sd_m = 0.01;
  double fix_yaw_sd_rad = 0.01;
  double speed_sd_fraction = 0.03;
  double yaw_rate_sd_radps = 0.02;
  /// Longer gaps are not bridged by dead reckoning. physical: a robot turns or stops within it.
  static constexpr double kOdometryGapMax_s = 1.0;
  double heading_baseline_m = 0.5;
  FusionConfig fusion;
  GnssConfig gnss;
  PriorMapConfig prior_map;
  SlamConfig slam;
  ScanMotionConfig scan_motion;
};

template <class Visitor>
void describe(Visitor& v, PoseConfig& c) {
  v.choice("mode", c.mode,
           {"fixes", "fixes_and_odometry", "odometry", "stationary", "fused", "prior_map", "slam"},
           "method of localisation");
  v.choice(
      "motion", c.motion, {"wheels", "scans"},
      "source of the motion in modes odometry, slam and prior_map: ODOMETRY alone, or matching of "
      "scans, together with ODOMETRY if there is any");
  v.expert().number("reorder_window_s", c.reorder_window_s, 0, 10, "s",
                    "max delay between channels (message time); for GNSS it is always 0.5 s");
  v.expert().number("fix_position_sd_m", c.fix_position_sd_m, 1e-6, 100, "m",
                    "standard deviation of the position of a POSE_FIX without covariance");
  v.expert().number("fix_yaw_sd_rad", c.fix_yaw_sd_rad, 1e-6, 3.2, "rad",
                    "standard deviation of the yaw of a POSE_FIX without covariance");
  v.expert().number(
      "speed_sd_fraction", c.speed_sd_fraction, 0, 1, "1",
      "standard deviation of the speed of ODOMETRY without covariance, as a fraction of the speed");
  v.expert().number("yaw_rate_sd_radps", c.yaw_rate_sd_radps, 0, 3.2, "rad/s",
                    "standard deviation of the yaw rate of ODOMETRY without covariance");
  v.expert().number("heading_baseline_m", c.heading_baseline_m, 0.01, 100, "m",
                    "distance to drive for a first heading, for fixes without yaw and GNSS");
  v.section("fusion", c.fusion, "mode fused: fusion of wheels, IMU, GNSS and fixes");
  v.section("gnss", c.gnss, "GNSS: datum, antenna and accuracy");
  v.section("prior_map", c.prior_map, "mode prior_map: localisation in an earlier map");
  v.check(c.mode != PoseMode::kPriorMap || !c.prior_map.map_file.empty(), "mode",
          "needs pose.prior_map.map_file: an earlier map");
  v.section("slam", c.slam, "mode slam: SLAM with trunks as landmarks");
  v.expert().section("scan_motion", c.scan_motion, "motion: scans: motion by matching of scans");
}

/// Returns which kinds of measurement the localiser uses, and how long to wait for each.
MeasurementWaits expected_measurements(const PoseConfig& config);

/// True if the motion of this mode is that of successive scans, with the wheels as a help.
bool reads_scans(const PoseConfig& config);

/// Returns the configuration with which mode `fused` uses what this mode names, and nothing else.
PoseConfig as_fused(PoseConfig config);

}  // namespace orchard::pose
