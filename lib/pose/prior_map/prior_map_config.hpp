// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::pose {

/// What is known of the place at the start.
enum class PriorStart {
  kGlobal,  ///< nothing: it is found from the trunks
  kGiven,   ///< start_x_m, start_y_m, start_yaw_rad
};

/// Localisation in the map of an earlier day. Section `pose.prior_map`.
struct PriorMapConfig {
  std::string map_file;  ///< map.csv, or the folder that holds it
  PriorStart start = PriorStart::kGlobal;
  double start_x_m = 0.0;  ///< of base in the prior map
  double start_y_m = 0.0;
  double start_yaw_rad = 0.0;
  double start_position_sd_m = 0.3;
  double start_yaw_sd_rad = 0.1;

  int min_observations = 2;            ///< landmarks seen less often are not used
  double landmark_sd_m = 0.05;         ///< of the map's positions among their neighbours
  double width_sd_m = 0.01;            ///< between the widths that two days measure of one trunk
  double sighting_sd_m = 0.02;         ///< of a centre, on top of what the detector states
  double sighting_range_max_m = 10.0;  ///< what is farther away is not used
  double sure_range_m = 4.0;           ///< within which an unhidden trunk is seen mostly
  double change_fraction = 0.05;       ///< of the trees that are gone, and that are new

  double speed_scale_sd = 0.03;           ///< of the wheels' size, unlearnt
  double turn_scale_sd = 0.03;            ///< the same of their turns
  double yaw_rate_bias_sd_radps = 0.005;  ///< the same of their yaw rate's bias
  double drift_sd_m = 0.01;  ///< of dead reckoning per root metre, on top of the wheels'

  double window_m = 15.0;       ///< travel whose trunks are compared with the map
  double search_every_m = 1.0;  ///< travel between searches, and between checks of a found place
  int min_trunks = 6;           ///< fewer are not searched for
  double pair_max_m = 8.0;      ///< between two trunks that begin a hypothesis
  int hypotheses_per_scan = 400;
  double min_log_odds = 9.0;  ///< of a place against all others together, to be taken
  double min_log_fit = 0.0;   ///< of it against another orchard of such rows, to be taken
  double lost_log_fit = 4.0;  ///< the other way round: of another orchard against the place
  double lost_share = 0.5;    ///< of trees that should be seen: when fewer are, it is lost
  double lost_sd_m = 1.0;     ///< a position less sure than this is lost
};

template <class Visitor>
void describe(Visitor& v, PriorMapConfig& c) {
  v.text("map_file", c.map_file, "map.csv of an earlier day, or the folder that holds it");
  v.choice("start", c.start, {"global", "given"}, "found from the trunks, or as start_* say");
  v.number("start_x_m", c.start_x_m, -1e8, 1e8, "m", "base in the prior map");
  v.number("start_y_m", c.start_y_m, -1e8, 1e8, "m", "base in the prior map");
  v.number("start_yaw_rad", c.start_yaw_rad, -6.2832, 6.2832, "rad", "base in the prior map");
  v.number("start_position_sd_m", c.start_position_sd_m, 0.001, 10, "m", "of a given start");
  v.number("start_yaw_sd_rad", c.start_yaw_sd_rad, 0.001, 1, "rad", "of a given start");
  v.integer("min_observations", c.min_observations, 0, 1000000, "1",
            "landmarks of the map seen less often are not used");
  v.number("landmark_sd_m", c.landmark_sd_m, 0.001, 1, "m",
           "of the map's positions among their neighbours");
  v.number("width_sd_m", c.width_sd_m, 0.001, 1, "m",
           "between the widths that two days measure of one trunk");
  v.number("sighting_sd_m", c.sighting_sd_m, 0.001, 1, "m",
           "of a centre, on top of what the detector states");
  v.number("sighting_range_max_m", c.sighting_range_max_m, 0.5, 200, "m",
           "what is farther away is not used");
  v.number("sure_range_m", c.sure_range_m, 0.5, 200, "m",
           "within which an unhidden trunk is seen mostly");
  v.number("change_fraction", c.change_fraction, 0.001, 0.5, "1",
           "of the trees that are gone, and that are new");
  v.number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1", "of the wheels' scale, unlearnt");
  v.number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1", "of the scale of their turns");
  v.number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
           "of their yaw rate's bias");
  v.number("drift_sd_m", c.drift_sd_m, 0, 1, "m",
           "of dead reckoning per root metre, on top of what odometry states");
  v.number("window_m", c.window_m, 2, 200, "m", "travel whose trunks are compared with the map");
  v.number("search_every_m", c.search_every_m, 0.1, 100, "m",
           "travel between searches, and between checks of a found place");
  v.integer("min_trunks", c.min_trunks, 3, 100, "trunks", "fewer are not searched for");
  v.number("pair_max_m", c.pair_max_m, 1, 50, "m", "between two trunks that begin a hypothesis");
  v.integer("hypotheses_per_scan", c.hypotheses_per_scan, 10, 1000000, "1",
            "tried at each scan: bounds its cost");
  v.number("min_log_odds", c.min_log_odds, 0, 100, "1",
           "natural logarithm: of a place against all others together, to be taken");
  v.number("min_log_fit", c.min_log_fit, 0, 100, "1",
           "natural logarithm: of a place against another orchard of such rows, to be taken");
  v.number("lost_log_fit", c.lost_log_fit, 0, 100, "1",
           "natural logarithm: of another orchard of such rows against the place: then it is lost");
  v.number("lost_share", c.lost_share, 0.05, 0.95, "1",
           "of trees that should be seen: when fewer are, it is lost");
  v.number("lost_sd_m", c.lost_sd_m, 0.05, 100, "m", "a position less sure than this is lost");
}

}  // namespace orchard::pose
