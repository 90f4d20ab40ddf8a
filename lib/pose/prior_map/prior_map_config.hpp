// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::pose {

/// Knowledge of the pose at the start.
enum class PriorStart {
  kGlobal,  ///< none: global localisation by the trunks
  kGiven,   ///< start_x_m, start_y_m, start_yaw_rad
};

/// Configuration of localisation in the map of an earlier day. Section `pose.prior_map`.
struct PriorMapConfig {
  std::string map_file;  ///< map.csv, or the folder that holds it
  PriorStart start = PriorStart::kGlobal;
  double start_x_m = 0.0;  ///< pose of base in the prior map
  double start_y_m = 0.0;
  double start_yaw_rad = 0.0;
  double start_position_sd_m = 0.3;
  double start_yaw_sd_rad = 0.1;

  int min_observations = 2;               ///< landmarks seen less often are not used
  double landmark_sd_m = 0.05;            ///< of a landmark relative to its neighbours
  double width_sd_m = 0.01;               ///< repeatability of a trunk's width between two days
  double observation_sd_m = 0.02;         ///< of a centre, added to the detector's covariance
  double observation_range_max_m = 10.0;  ///< farther objects are not used
  double detection_range_m = 4.0;         ///< range within which most unoccluded trunks are seen

  double speed_scale_sd = 0.03;           ///< prior of the wheels' speed scale
  double turn_scale_sd = 0.03;            ///< prior of the scale of their turns
  double yaw_rate_bias_sd_radps = 0.005;  ///< prior of their yaw rate bias

  double window_m = 15.0;  ///< length of the path whose trunks are compared with the map
};

template <class Visitor>
void describe(Visitor& v, PriorMapConfig& c) {
  v.text("map_file", c.map_file, "map.csv of an earlier day, or the folder that holds it");
  v.expert().choice("start", c.start, {"global", "given"},
                    "found from the trunks, or as start_* say");
  v.expert().number("start_x_m", c.start_x_m, -1e8, 1e8, "m", "base in the prior map");
  v.expert().number("start_y_m", c.start_y_m, -1e8, 1e8, "m", "base in the prior map");
  v.expert().number("start_yaw_rad", c.start_yaw_rad, -6.2832, 6.2832, "rad",
                    "base in the prior map");
  v.expert().number("start_position_sd_m", c.start_position_sd_m, 0.001, 10, "m",
                    "of a given start");
  v.expert().number("start_yaw_sd_rad", c.start_yaw_sd_rad, 0.001, 1, "rad", "of a given start");
  v.expert().integer("min_observations", c.min_observations, 0, 1000000, "1",
                     "landmarks of the map seen less often are not used");
  v.expert().number("landmark_sd_m", c.landmark_sd_m, 0.001, 1, "m",
                    "of the map's positions among their neighbours");
  v.expert().number("width_sd_m", c.width_sd_m, 0.001, 1, "m",
                    "between the widths that two days measure of one trunk");
  v.expert().number("observation_sd_m", c.observation_sd_m, 0.001, 1, "m",
                    "of a centre, on top of what the detector states");
  v.expert().number("observation_range_max_m", c.observation_range_max_m, 0.5, 200, "m",
                    "what is farther away is not used");
  v.expert().number("detection_range_m", c.detection_range_m, 0.5, 200, "m",
                    "within which an unhidden trunk is seen mostly");
  v.expert().number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
                    "of the wheels' scale, unlearnt");
  v.expert().number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1", "of the scale of their turns");
  v.expert().number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
                    "of their yaw rate's bias");
  v.expert().number("window_m", c.window_m, 2, 200, "m",
                    "travel whose trunks are compared with the map");
  v.check(c.detection_range_m <= c.observation_range_max_m, "detection_range_m",
          "must not be above observation_range_max_m");
}

}  // namespace orchard::pose
