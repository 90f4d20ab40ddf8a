// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Trunk-landmark SLAM. Section `pose.slam`.
struct SlamConfig {
  double detections_wait_s = 0.5;  ///< of message time: how far DETECTIONS may lag the motion
  double keyframe_travel_m = 0.5;
  double keyframe_turn_rad = 0.3;
  int window_keyframes = 30;  ///< corrected at every keyframe

  double sighting_sd_m = 0.02;       ///< of a centre, on top of what the detector states
  double sighting_sd_widths = 0.1;   ///< the same, per width of the object
  double occluded_sd_widths = 0.25;  ///< the same, when something nearer hides part of it
  double object_sd_m = 0.05;         ///< the same, for what is labelled an object
  double sight_range_max_m = 30.0;   ///< what is farther away is no landmark
  double width_max_m = 1.5;          ///< what is wider has no centre to speak of

  double gate_sigma = 3.5;        ///< joint gate of association
  double gate_m = 0.6;            ///< a sighting is never matched to a landmark farther away
  double width_gate_m = 0.15;     ///< widths may differ by this on top of what is stated
  double new_landmark_m = 0.6;    ///< nearer to a landmark than this nothing new is begun
  int confirm_keyframes = 3;      ///< sightings in as many keyframes make a landmark
  double confirm_travel_m = 1.0;  ///< and from places this far apart
  /// Share of a keyframe's scans below which what it saw was none: ground and leaves flash up.
  double sighting_share_min = 0.0;
  double outlier_sigma = 3.0;  ///< where the robust loss of a sighting bends

  double speed_scale_sd = 0.05;          ///< of the wheels' scale before anything is learnt
  double turn_scale_sd = 0.03;           ///< the same of their turns
  double yaw_rate_bias_sd_radps = 0.01;  ///< the same of their yaw rate's bias
  double calibration_travel_m = 50.0;    ///< travel over which these are taken as constant
  double calibration_walk_fraction =
      0.1;  ///< they wander by this share of the above per such travel

  double gap_s = 0.5;             ///< a longer silence of the motion is a gap
  double gap_speed_sd_mps = 0.5;  ///< how far the speed strays from the last one in a gap
  double gap_yaw_rate_sd_radps = 0.3;

  double lost_sd_m = 0.8;  ///< less surely placed among its landmarks, a map of its own begins

  double recent_travel_m = 20.0;    ///< what was seen within is where the robot is
  double covisible_travel_m = 8.0;  ///< what was passed so near to a tracked landmark is as well
  double closure_stretch_m = 25.0;  ///< of path whose landmarks are laid onto old ones
  double closure_every_m = 2.0;     ///< a loop closure is looked for as often
  int closure_min_trees = 5;        ///< distinct landmarks that a closure takes
  double closure_kernel_m = 0.4;    ///< of a pair of landmarks, after the best shift
  double closure_sd_m = 0.04;       ///< by which a tree's place repeats on a stretch of map
  double closure_margin = 8.0;      ///< log-likelihood by which it must beat any other shift
  double closure_search_max_m = 15.0;
  bool use_fixes = false;        ///< POSE_FIX places the map and bounds its drift
  bool use_gnss = false;         ///< GNSS does, with map east-north-up about its datum
  double place_travel_m = 5.0;   ///< between fixes that turn the map to them
  double place_sd_min_m = 0.02;  ///< no fix is believed to be better
  double merge_m = 0.4;          ///< landmarks that end up nearer to each other are one
  double solve_growth = 0.1;     ///< the whole graph is solved when it has grown by this share
  int solve_keyframes = 500;     ///< larger graphs are solved by stretches of path
  int final_keyframes = 5000;    ///< the same of the last solve, at the end of the drive
  double solve_stretch_m = 8.0;  ///< length of such a stretch, which keeps its shape
};

template <class Visitor>
void describe(Visitor& v, SlamConfig& c) {
  v.number("detections_wait_s", c.detections_wait_s, 0, 60, "s",
           "message time that DETECTIONS may lag the motion");
  v.number("keyframe_travel_m", c.keyframe_travel_m, 0.05, 10, "m", "travel between keyframes");
  v.number("keyframe_turn_rad", c.keyframe_turn_rad, 0.02, 3.1, "rad", "turn between keyframes");
  v.integer("window_keyframes", c.window_keyframes, 4, 200, "keyframes",
            "corrected at every keyframe");
  v.number("sighting_sd_m", c.sighting_sd_m, 0.001, 1, "m",
           "of a centre, on top of what the detector states");
  v.number("sighting_sd_widths", c.sighting_sd_widths, 0, 1, "1", "the same, per width");
  v.number("occluded_sd_widths", c.occluded_sd_widths, 0, 2, "1",
           "the same, per width of something half hidden");
  v.number("object_sd_m", c.object_sd_m, 0, 1, "m", "the same, of what is labelled an object");
  v.number("sight_range_max_m", c.sight_range_max_m, 0.5, 200, "m",
           "what is farther away is no landmark");
  v.number("width_max_m", c.width_max_m, 0.05, 10, "m", "what is wider is no landmark");
  v.number("gate_sigma", c.gate_sigma, 1, 10, "sigma", "of association");
  v.number("gate_m", c.gate_m, 0.05, 10, "m", "most from a sighting to its landmark");
  v.number("width_gate_m", c.width_gate_m, 0, 5, "m",
           "widths may differ by this on top of what is stated");
  v.number("new_landmark_m", c.new_landmark_m, 0.05, 10, "m",
           "nearer to a landmark than this nothing new is begun");
  v.integer("confirm_keyframes", c.confirm_keyframes, 1, 100, "keyframes",
            "that must have seen a landmark");
  v.number("confirm_travel_m", c.confirm_travel_m, 0, 20, "m",
           "between the first and the last of them");
  v.number("sighting_share_min", c.sighting_share_min, 0, 1, "1",
           "share of a keyframe's scans that must have seen an object");
  v.number("outlier_sigma", c.outlier_sigma, 1, 20, "sigma",
           "where the robust loss of a sighting bends");
  v.number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1", "of the wheels' scale");
  v.number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1", "of the scale of their turns");
  v.number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
           "of their yaw rate's bias");
  v.number("calibration_travel_m", c.calibration_travel_m, 5, 1e6, "m",
           "over which these are taken as constant");
  v.number("calibration_walk_fraction", c.calibration_walk_fraction, 1e-4, 10, "1",
           "share of the above by which they wander per such travel");
  v.number("gap_s", c.gap_s, 0.01, 60, "s", "a longer silence of the motion is a gap");
  v.number("gap_speed_sd_mps", c.gap_speed_sd_mps, 0.01, 10, "m/s",
           "how far the speed strays in a gap");
  v.number("gap_yaw_rate_sd_radps", c.gap_yaw_rate_sd_radps, 0.01, 10, "rad/s",
           "how far the yaw rate strays in a gap");
  v.number("lost_sd_m", c.lost_sd_m, 0.1, 20, "m",
           "1-sigma of the place among the trunks from which on none is known again; about a third "
           "of their spacing");
  v.number("recent_travel_m", c.recent_travel_m, 2, 1000, "m",
           "what was seen within it is where the robot is");
  v.number("covisible_travel_m", c.covisible_travel_m, 0, 1000, "m",
           "what was passed so near to a tracked landmark is there too");
  v.number("closure_stretch_m", c.closure_stretch_m, 2, 1000, "m",
           "path whose landmarks are laid onto old ones");
  v.number("closure_every_m", c.closure_every_m, 0.1, 1000, "m",
           "travel between two looks for a loop closure");
  v.integer("closure_min_trees", c.closure_min_trees, 3, 1000, "landmarks",
            "that a loop closure takes");
  v.number("closure_kernel_m", c.closure_kernel_m, 0.02, 5, "m",
           "most between two landmarks that a closure takes for one");
  v.number("closure_sd_m", c.closure_sd_m, 0.01, 1, "m",
           "by which a tree's place repeats on a stretch of map");
  v.number("closure_margin", c.closure_margin, 0, 100, "log-likelihood",
           "by which a closure must beat any other shift");
  v.number("closure_search_max_m", c.closure_search_max_m, 0.5, 200, "m",
           "farthest shift looked for");
  v.flag("use_fixes", c.use_fixes, "POSE_FIX places the map and bounds its drift");
  v.flag("use_gnss", c.use_gnss, "GNSS does, with map east-north-up about pose.gnss.datum");
  v.number("place_travel_m", c.place_travel_m, 0.5, 1000, "m",
           "between fixes without heading that turn the map to them");
  v.number("place_sd_min_m", c.place_sd_min_m, 0.001, 10, "m", "no fix is believed to be better");
  v.number("merge_m", c.merge_m, 0, 5, "m", "landmarks nearer to each other are one");
  v.number("solve_growth", c.solve_growth, 0.01, 10, "1",
           "the whole graph is solved when it has grown by this share");
  v.integer("solve_keyframes", c.solve_keyframes, 2, 1000000, "keyframes",
            "whole graphs with more are solved by stretches of path that keep their shape");
  v.integer("final_keyframes", c.final_keyframes, 2, 1000000, "keyframes",
            "the same of the last solve; also with more than a fifth as many landmarks");
  v.number("solve_stretch_m", c.solve_stretch_m, 0.5, 1000, "m", "length of such a stretch");
}

}  // namespace orchard::pose
