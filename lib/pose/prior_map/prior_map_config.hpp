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
  std::string map_file;
  PriorStart start = PriorStart::kGlobal;
  double start_x_m = 0.0;
  double start_y_m = 0.0;
  double start_yaw_rad = 0.0;
  static constexpr double kStartPositionSd_m = 0.3;
  static constexpr double kStartYawSd_rad = 0.1;

  int min_observations = 2;
  static constexpr double kLandmarkSd_m = 0.05;  ///< of a landmark relative to its neighbours
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
  v.text("map_file", c.map_file, "map.csv of an earlier drive, or its folder");
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

}  // namespace orchard::pose
