// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Configuration of trunk-landmark SLAM. Section `pose.slam`.
struct SlamConfig {
  double detections_wait_s = 0.5;  ///< max lag of DETECTIONS behind the motion [message time]
  double keyframe_travel_m = 0.5;
  int window_keyframes = 30;  ///< corrected at every keyframe

  double observation_sd_m = 0.02;         ///< of a centre, added to the detector's covariance
  double observation_range_max_m = 30.0;  ///< farther objects are not used
  double width_max_m = 1.5;               ///< wider objects have no well-defined centre

  double gate_sigma = 3.5;      ///< joint gate of association
  double gate_m = 0.6;          ///< max distance of an observation from its landmark
  double width_gate_m = 0.15;   ///< allowed difference of widths, added to their uncertainty
  double new_landmark_m = 0.6;  ///< min distance of a new landmark from existing ones
  /// Minimum detection rate per keyframe; rarer detections are clutter.
  double detection_rate_min = 0.0;

  double speed_scale_sd = 0.05;          ///< prior of the wheels' speed scale
  double turn_scale_sd = 0.1;            ///< prior of the scale of their turns
  double yaw_rate_bias_sd_radps = 0.01;  ///< prior of their yaw rate bias

  double gap_s = 0.5;  ///< a longer time without measured motion is a gap

  double lost_sd_m = 0.8;  ///< a larger 1-sigma against the landmarks starts a new session

  double closure_kernel_m = 0.4;  ///< max distance of matched landmarks after registration
  double closure_sd_m = 0.04;     ///< repeatability of a tree's position within a submap
  double closure_margin = 8.0;    ///< min log-likelihood margin over any other registration
  bool use_fixes = false;         ///< POSE_FIX georeferences the map and bounds its drift
  bool use_gnss = false;          ///< GNSS does so; map is then east-north about its datum
  double merge_m = 0.4;           ///< landmarks nearer than this after a solve are merged
  double submap_length_m = 8.0;   ///< path length of the submaps by which large graphs are solved
};

template <class Visitor>
void describe(Visitor& v, SlamConfig& c) {
  v.expert().number("detections_wait_s", c.detections_wait_s, 0, 60, "s",
                    "message time that DETECTIONS may lag the motion");
  v.expert().number("keyframe_travel_m", c.keyframe_travel_m, 0.05, 10, "m",
                    "travel between keyframes");
  v.expert().integer("window_keyframes", c.window_keyframes, 4, 200, "keyframes",
                     "corrected at every keyframe");
  v.expert().number("observation_sd_m", c.observation_sd_m, 0.001, 1, "m",
                    "of a centre, on top of what the detector states");
  v.expert().number("observation_range_max_m", c.observation_range_max_m, 0.5, 200, "m",
                    "what is farther away is no landmark");
  v.expert().number("width_max_m", c.width_max_m, 0.05, 10, "m", "what is wider is no landmark");
  v.expert().number("gate_sigma", c.gate_sigma, 1, 10, "sigma", "of association");
  v.number("gate_m", c.gate_m, 0.05, 10, "m", "farthest an observation lies from its landmark");
  v.expert().number("width_gate_m", c.width_gate_m, 0, 5, "m",
                    "widths may differ by this on top of what is stated");
  v.expert().number("new_landmark_m", c.new_landmark_m, 0.05, 10, "m",
                    "nearer to a landmark than this nothing new is begun");
  v.expert().number(
      "detection_rate_min", c.detection_rate_min, 0, 1, "1",
      "fraction of a keyframe's scans that must observe a landmark: ground and leaves flash up");
  v.expert().number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1", "of the wheels' scale");
  v.expert().number("turn_scale_sd", c.turn_scale_sd, 0, 0.5, "1", "of the scale of their turns");
  v.expert().number("yaw_rate_bias_sd_radps", c.yaw_rate_bias_sd_radps, 0, 1, "rad/s",
                    "of their yaw rate's bias");
  v.expert().number("gap_s", c.gap_s, 0.01, 60, "s", "a longer silence of the motion is a gap");
  v.expert().number(
      "lost_sd_m", c.lost_sd_m, 0.1, 20, "m",
      "1-sigma of the place among the trunks from which on none is known again; about a third "
      "of their spacing");
  v.expert().number("closure_kernel_m", c.closure_kernel_m, 0.02, 5, "m",
                    "landmarks farther apart after the best shift are no pair");
  v.expert().number("closure_sd_m", c.closure_sd_m, 0.01, 1, "m",
                    "repeatability of a tree's position within a submap, standard deviation");
  v.expert().number("closure_margin", c.closure_margin, 0, 100, "log-likelihood",
                    "by which a loop closure must beat any other shift");
  v.flag("use_fixes", c.use_fixes, "POSE_FIX places the map and bounds its drift");
  v.flag("use_gnss", c.use_gnss, "GNSS does, with map east-north-up about pose.gnss.datum");
  v.expert().number("merge_m", c.merge_m, 0, 5, "m", "landmarks nearer to each other are one");
  v.expert().number("submap_length_m", c.submap_length_m, 0.5, 1000, "m",
                    "large graphs are solved by submaps of the path of this length");
  v.check(c.merge_m <= c.gate_m, "merge_m", "must not be above gate_m");
  v.check(c.merge_m <= c.new_landmark_m, "merge_m", "must not be above new_landmark_m");
}

}  // namespace orchard::pose
