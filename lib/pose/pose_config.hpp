// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/filter/fusion_config.hpp"
#include "pose/gnss_config.hpp"
#include "pose/prior_map/prior_map_config.hpp"
#include "pose/scan_matching/scan_motion_config.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

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
  kScans,   ///< SCAN: each scan is matched to the previous ones
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
  static constexpr double kOdometryGapMax_s =
      1.0;  ///< longer gaps are not bridged by dead reckoning
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
      "source of the motion in modes odometry, slam and prior_map: ODOMETRY, or matching of scans");
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

}  // namespace orchard::pose
