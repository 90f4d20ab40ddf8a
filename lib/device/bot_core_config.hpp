// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::device {

/// Conversion of libbot's pose_t.
enum class BotPoseAs {
  kOdometry,  ///< to velocities: for a drifting pose, as from wheels or an estimator without a map
  kPoseFix,   ///< to external positions: from motion capture, a total station or localisation in a
              ///< map
};

/// A robot that publishes libbot's types. Section `drivers.bot_core`.
struct BotCoreConfig {
  std::string lcm_url;
  std::string scan_channel;
  std::string image_channel;
  std::string pose_channel;
  std::string gps_channel;
  BotPoseAs pose_as = BotPoseAs::kOdometry;
  double range_min_m = 0.05;
  double range_max_m = 30.0;
};

template <class Visitor>
void describe(Visitor& v, BotCoreConfig& c) {
  v.text("lcm_url", c.lcm_url,
         "URL of the LCM network of a robot with libbot's types; empty = none");
  v.text("scan_channel", c.scan_channel, "channel of planar_lidar_t; empty = the first one found");
  v.text("image_channel", c.image_channel, "channel of image_t; empty = the first one found");
  v.text("pose_channel", c.pose_channel, "channel of pose_t; empty = the first one found");
  v.text("gps_channel", c.gps_channel, "channel of gps_data_t; empty = the first one found");
  v.choice("pose_as", c.pose_as, {"odometry", "pose_fix"},
           "pose_t is converted to: velocities (ODOMETRY) | external positions (POSE_FIX)");
  v.number("range_min_m", c.range_min_m, 0, 10, "m",
           "min range of the scanner, which planar_lidar_t does not state; from the data sheet");
  v.number("range_max_m", c.range_max_m, 0.1, 1000, "m",
           "max range of the scanner, which planar_lidar_t does not state; from the data sheet");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

}  // namespace orchard::device
