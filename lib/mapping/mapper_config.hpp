// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/existence/existence_config.hpp"
#include "mapping/rows/rows_config.hpp"

namespace orchard::mapping {

/// What a look says of a landmark's class.
enum class Evidence {
  kLabels,       ///< its label, by the shares below
  kProbability,  ///< its calibrated probability_tree
};

/// How detections become landmarks. Section `mapper`.
struct MapperConfig {
  double gate_m = 0.30;               ///< farthest a detection may lie from its landmark
  double gate_sigma = 3.5;            ///< the same in standard deviations of all that is uncertain
  double width_gate_m = 0.25;         ///< largest difference between the widths of one thing
  int well_known_observations = 30;   ///< from here on a landmark takes what strays from it
  double merge_m = 0.10;              ///< landmarks nearer than this are one
  double apart_m = 0.60;              ///< farther apart, what scans show at once is two things
  double range_use_max_m = 100.0;     ///< farther detections are left out (range from base)
  bool align_scans = true;            ///< who is who is decided after fitting the scan to the map
  double align_kernel_m = 0.15;       ///< how far from a landmark a detection still supports a fit
  double centre_kernel_m = 0.20;      ///< observations farther from the bulk weigh little
  double tree_rate_of_trees = 0.8;    ///< share of a tree's observations that are labelled TREE
  double tree_rate_of_objects = 0.2;  ///< share of an object's
  Evidence evidence = Evidence::kLabels;
  double evidence_prior = 0.5;        ///< share of trees among landmarks
  double evidence_base_rate = 0.5;    ///< share of trees among looks, where they were calibrated
  double evidence_correlation = 0.2;  ///< of two looks at one thing, beyond what the class explains
  double rederive_m = 0.02;           ///< of corrected poses, before landmarks are derived anew
  double pose_wait_s = 10.0;          ///< of message time: how long DETECTIONS wait for a POSE
  double pose_gap_max_s = 2.0;        ///< poses farther apart are not interpolated between
  /// Poses at least this often place each detection at its own beam's time, sparser ones all of a
  /// scan at its first beam's: a robot that is measured at stops does not move while it scans.
  double sweep_pose_gap_max_s = 0.25;
  int min_observations = 1;       ///< landmarks seen less often are left out of map files
  double refresh_period_s = 2.0;  ///< of message time: between two slow refreshes of MAP
  double refresh_per_s = 200.0;   ///< landmarks refreshed at most: large maps come round less often
  PresenceConfig presence;
  RowsConfig rows;
};

template <class Visitor>
void describe(Visitor& v, MapperConfig& c) {
  v.number("gate_m", c.gate_m, 0.01, 0.99, "m", "farthest a detection lies from its landmark");
  v.number("gate_sigma", c.gate_sigma, 0.5, 20, "1",
           "the same in standard deviations of detection, pose and landmark");
  v.number("width_gate_m", c.width_gate_m, 0.01, 10, "m",
           "largest difference between a detection's width and its landmark's");
  v.integer("well_known_observations", c.well_known_observations, 1, 1000000, "1",
            "from here on a landmark takes what lies beyond gate_sigma, but within gate_m and as "
            "wide, unless the same scan shows the landmark itself");
  v.number("merge_m", c.merge_m, 0, 0.99, "m", "landmarks nearer than this are one");
  v.number(
      "apart_m", c.apart_m, 0.01, 5, "m",
      "farther apart, what scans show at once time and again is two things within gate_m, too");
  v.number("range_use_max_m", c.range_use_max_m, 0.1, 500, "m",
           "detections farther from base are left out");
  v.flag("align_scans", c.align_scans,
         "decide who is who after fitting the scan to the map, within the pose's covariance");
  v.number("align_kernel_m", c.align_kernel_m, 0.01, 2, "m",
           "how far from a landmark a detection still supports a fit");
  v.number("centre_kernel_m", c.centre_kernel_m, 0.01, 5, "m",
           "observations farther than this from the bulk weigh little");
  v.number("tree_rate_of_trees", c.tree_rate_of_trees, 0.01, 0.99, "1",
           "share of a tree's observations that are labelled TREE");
  v.number("tree_rate_of_objects", c.tree_rate_of_objects, 0.01, 0.99, "1",
           "share of an object's observations that are labelled TREE");
  v.choice("evidence", c.evidence, {"labels", "probability"},
           "what a look says of a landmark's class: its label, or its calibrated probability");
  v.number("evidence_prior", c.evidence_prior, 0.01, 0.99, "1",
           "evidence probability: share of trees among landmarks");
  v.number("evidence_base_rate", c.evidence_base_rate, 0.01, 0.99, "1",
           "evidence probability: share of trees among the looks that were learnt from");
  v.number("evidence_correlation", c.evidence_correlation, 0, 1, "1",
           "evidence probability: n looks count as n / (1 + (n - 1) x this)");
  v.number("rederive_m", c.rederive_m, 0.001, 10, "m",
           "corrections of the past that together move base farther derive the landmarks anew");
  v.number("pose_wait_s", c.pose_wait_s, 0, 3600, "s",
           "message time that detections wait for a pose");
  v.number("pose_gap_max_s", c.pose_gap_max_s, 0.001, 3600, "s",
           "poses farther apart are not interpolated between");
  v.number("sweep_pose_gap_max_s", c.sweep_pose_gap_max_s, 0, 10, "s",
           "poses at least this often undo the motion within a scan; 0 = never");
  v.integer("min_observations", c.min_observations, 1, 1000, "1",
            "landmarks seen less often stay out of map files");
  v.number("refresh_period_s", c.refresh_period_s, 0.05, 3600, "s",
           "message time between two refreshes of the whole map");
  v.number("refresh_per_s", c.refresh_per_s, 1, 1e6, "landmarks/s",
           "refreshed at most: larger maps take longer than refresh_period_s to come round");
  v.section("presence", c.presence, "what was seen and is there no more");
  v.section("rows", c.rows, "rows and numbers");
  v.check(c.tree_rate_of_objects < c.tree_rate_of_trees, "tree_rate_of_objects",
          "must be below tree_rate_of_trees");
}

}  // namespace orchard::mapping
