// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// How the robot's motion is read from its scans. Section `pose.scan_motion`.
struct ScanMotionConfig {
  double range_min_m = 0.3;   ///< nearer returns are the robot itself
  double range_max_m = 30.0;  ///< farther returns are not used
  bool deskew = true;         ///< undo the motion within a scan, where it states its beam period
  double thin_m = 0.10;       ///< one point per square of this side is registered
  double normal_radius_m = 0.30;  ///< neighbours within make a point's normal
  double flatness_max = 0.05;     ///< thickness to length (squares) up to which they are a wall

  double map_radius_m = 50.0;    ///< the local map reaches at least so far around the robot
  double map_travel_m = 15.0;    ///< what was last seen so much travel ago is forgotten; 0 = never
  double map_spacing_m = 0.07;   ///< between points of the map
  int map_cell_points_max = 16;  ///< in one square of map_cell_m
  double map_cell_m = 0.4;

  double pair_max_m = 0.6;      ///< farthest pair of the first rounds
  double pair_fine_m = 0.25;    ///< of the last rounds
  double kernel_m = 0.3;        ///< distance at which a pair loses half its say, first rounds
  double kernel_fine_m = 0.10;  ///< the same in the last rounds
  int iterations_max = 25;      ///< of each kind of round

  double score_kernel_m = 0.15;   ///< distance that counts as a good fit
  double score_good = 0.75;       ///< share of good fits below which the neighbourhood is searched
  double score_reliable = 0.35;   ///< below it the motion is a guess
  double score_advantage = 0.05;  ///< by which a place found by search must be better
  double search_turn_rad = 0.6;   ///< to each side of the expected turn
  double search_shift_m = 0.6;    ///< to each side of the expected place
  int search_candidates = 6;      ///< best places of the search that are refined
  int points_min = 20;            ///< fewer returns say nothing of the motion

  double residual_sd_m = 0.02;      ///< 1-sigma of a pair, at least
  double correlated_points = 4.0;   ///< points that err together: they count as one
  double unknown_shift_sd_m = 0.5;  ///< of the motion before a scan is looked at
  double unknown_turn_sd_rad = 0.3;
  double reliable_shift_sd_m = 0.10;  ///< a motion with more is not reliable
  double reliable_turn_sd_rad = 0.03;
};

template <class Visitor>
void describe(Visitor& v, ScanMotionConfig& c) {
  v.number("range_min_m", c.range_min_m, 0, 100, "m", "nearer returns are the robot itself");
  v.number("range_max_m", c.range_max_m, 0.5, 500, "m", "farther returns are not used");
  v.flag("deskew", c.deskew, "undo the motion within a scan that states its beam period");
  v.number("thin_m", c.thin_m, 0, 2, "m", "one return per square of this side is registered");
  v.number("normal_radius_m", c.normal_radius_m, 0.01, 5, "m",
           "neighbouring returns within tell the surface's direction");
  v.number("flatness_max", c.flatness_max, 0, 1, "1",
           "thickness over length, squared, up to which they are a smooth wall");
  v.number("map_radius_m", c.map_radius_m, 5, 500, "m", "reach of the local map");
  v.number("map_travel_m", c.map_travel_m, 0, 1e6, "m",
           "travel after which what was not seen again is forgotten; 0 = never");
  v.number("map_spacing_m", c.map_spacing_m, 0.01, 1, "m", "between points of the local map");
  v.integer("map_cell_points_max", c.map_cell_points_max, 1, 100, "points",
            "in one cell of the local map");
  v.number("map_cell_m", c.map_cell_m, 0.1, 2, "m", "side of a cell of the local map");
  v.number("pair_max_m", c.pair_max_m, 0.05, 5, "m", "farthest pair of the first rounds");
  v.number("pair_fine_m", c.pair_fine_m, 0.02, 5, "m", "farthest pair of the last rounds");
  v.number("kernel_m", c.kernel_m, 0.01, 5, "m", "scale of the robust kernel, first rounds");
  v.number("kernel_fine_m", c.kernel_fine_m, 0.01, 5, "m", "the same in the last rounds");
  v.integer("iterations_max", c.iterations_max, 1, 200, "rounds", "of each of the two kinds");
  v.number("score_kernel_m", c.score_kernel_m, 0.01, 5, "m", "distance that is a good fit");
  v.number("score_good", c.score_good, 0, 1, "1",
           "share of good fits below which the neighbourhood is searched");
  v.number("score_reliable", c.score_reliable, 0, 1, "1", "below it the motion is a guess");
  v.number("score_advantage", c.score_advantage, 0, 1, "1",
           "by which a place found by search must fit better");
  v.number("search_turn_rad", c.search_turn_rad, 0, 3.1416, "rad",
           "turn to each side of the expected one that is searched");
  v.number("search_shift_m", c.search_shift_m, 0, 5, "m",
           "distance to each side of the expected place that is searched");
  v.integer("search_candidates", c.search_candidates, 1, 100, "places", "that are refined");
  v.integer("points_min", c.points_min, 3, 10000, "returns", "fewer say nothing of the motion");
  v.number("residual_sd_m", c.residual_sd_m, 1e-4, 1, "m", "1-sigma of a pair, at least");
  v.number("correlated_points", c.correlated_points, 1, 1000, "points",
           "that err together and count as one");
  v.number("unknown_shift_sd_m", c.unknown_shift_sd_m, 0.01, 100, "m",
           "1-sigma of a motion of which the scans tell nothing");
  v.number("unknown_turn_sd_rad", c.unknown_turn_sd_rad, 0.01, 3.2, "rad", "the same of its turn");
  v.number("reliable_shift_sd_m", c.reliable_shift_sd_m, 0.001, 100, "m",
           "1-sigma up to which a motion is reliable");
  v.number("reliable_turn_sd_rad", c.reliable_turn_sd_rad, 1e-4, 3.2, "rad",
           "the same of its turn");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

}  // namespace orchard::pose
