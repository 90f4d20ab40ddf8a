// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

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

}  // namespace orchard::pose
