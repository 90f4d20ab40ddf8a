// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/filter/fusion_config.hpp"
#include "pose/filter/gnss_config.hpp"
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
  MotionSource motion = MotionSource::kWheels;  ///< modes odometry, slam, prior_map
  double reorder_window_s = 0.02;               ///< max lag between channels [s of message time]
  double fix_position_sd_m = 0.01;              ///< of a fix without covariance
  double fix_yaw_sd_rad = 0.01;
  double speed_sd_fraction = 0.03;  ///< of odometry without covariance
  double yaw_rate_sd_radps = 0.02;
  double odometry_gap_max_s = 1.0;  ///< longer gaps are not bridged by dead reckoning
  double heading_baseline_m = 0.5;  ///< travel needed for a first heading from fixes without yaw
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
           "where poses come from");
  v.choice("motion", c.motion, {"wheels", "scans"},
           "modes odometry, slam, prior_map: motion from ODOMETRY | from the scans");
  v.expert().number("reorder_window_s", c.reorder_window_s, 0, 10, "s",
                    "message time that one channel may lag another; GNSS always half a second");
  v.number("fix_position_sd_m", c.fix_position_sd_m, 1e-6, 100, "m",
           "of a fix that states no covariance");
  v.number("fix_yaw_sd_rad", c.fix_yaw_sd_rad, 1e-6, 3.2, "rad",
           "of a fix that states no covariance");
  v.number("speed_sd_fraction", c.speed_sd_fraction, 0, 1, "1",
           "of odometry that states no covariance, per m/s");
  v.number("yaw_rate_sd_radps", c.yaw_rate_sd_radps, 0, 3.2, "rad/s",
           "of odometry that states no covariance");
  v.expert().number("odometry_gap_max_s", c.odometry_gap_max_s, 0.001, 3600, "s",
                    "a longer silence is not dead-reckoned across");
  v.expert().number("heading_baseline_m", c.heading_baseline_m, 0.01, 100, "m",
                    "travel that gives a first heading to fixes without yaw and to GNSS");
  v.section("fusion", c.fusion, "mode fused: wheels, IMU, GNSS and fixes together");
  v.section("gnss", c.gnss, "how satellite fixes are used");
  v.section("prior_map", c.prior_map, "localisation in an earlier day's map: mode prior_map");
  v.check(c.mode != PoseMode::kPriorMap || !c.prior_map.map_file.empty(), "mode",
          "needs pose.prior_map.map_file: the map of an earlier day");
  v.section("slam", c.slam, "trunk-landmark SLAM: mode slam");
  v.expert().section("scan_motion", c.scan_motion, "motion: scans");
}

}  // namespace orchard::pose
