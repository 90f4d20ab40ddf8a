// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/album/album_config.hpp"
#include "mapping/existence/existence_config.hpp"
#include "mapping/rows/rows_config.hpp"

namespace orchard::mapping {

/// What an observation says of a landmark's class.
enum class Evidence {
  kLabels,       ///< its label, by the shares below
  kProbability,  ///< its calibrated probability_tree
};

/// How detections become landmarks. Section `mapper`.
struct MapperConfig {
  double gate_m = 0.30;            ///< farthest a detection may lie from its landmark
  double gate_sigma = 3.5;         ///< the same in standard deviations of all that is uncertain
  double width_gate_m = 0.25;      ///< largest difference between the widths of one thing
  double merge_m = 0.10;           ///< landmarks nearer than this are one
  bool split_landmarks = true;     ///< a landmark that scans show at two positions at once is two
  double split_distance_m = 0.60;  ///< least distance of those positions
  double observation_range_max_m = 100.0;  ///< farther detections are left out (range from base)
  bool align_scans = true;        ///< who is who is decided after fitting the scan to the map
  double align_kernel_m = 0.15;   ///< how far from a landmark a detection still supports a fit
  double centre_kernel_m = 0.20;  ///< observations farther from the bulk weigh little
  Evidence evidence = Evidence::kLabels;
  double evidence_prior = 0.5;        ///< fraction of trees among landmarks
  double evidence_base_rate = 0.5;    ///< fraction of trees among the calibration's observations
  double evidence_correlation = 0.2;  ///< of two observations of one thing, given its class
  double pose_wait_s = 10.0;          ///< of message time: how long DETECTIONS wait for a POSE
  double pose_gap_max_s = 2.0;        ///< poses farther apart are not interpolated between
  /// Poses at least this often place each detection at its own beam's time, sparser ones all of a
  /// scan at its first beam's: a robot that is measured at stops does not move while it scans.
  double deskew_pose_gap_max_s = 0.25;
  int min_observations = 1;  ///< landmarks seen less often are left out of map files
  /// No key of its own but detector.segmentation.min_beams: what fewer met was not handed over.
  int fewest_beams = 1;
  /// Nor this, but width_max_m there: what is wider was not handed over whole.
  double widest_m = 2.0;
  /// Nor this: whether detector.segmentation.reflector is `only`, and a TREE is what flashed.
  bool flash_tells = false;
  ExistenceConfig existence;
  AlbumConfig album;
  RowsConfig rows;
};

template <class Visitor>
void describe(Visitor& v, MapperConfig& c) {
  v.number("gate_m", c.gate_m, 0.01, 0.99, "m", "farthest a detection lies from its landmark");
  v.expert().number("gate_sigma", c.gate_sigma, 0.5, 20, "1",
                    "the same in standard deviations of detection, pose and landmark");
  v.number("width_gate_m", c.width_gate_m, 0.01, 10, "m",
           "largest difference between a detection's width and its landmark's");
  v.number("merge_m", c.merge_m, 0, 0.99, "m", "landmarks nearer than this are one");
  v.check(c.merge_m <= 2.0 * c.gate_m, "merge_m",
          "must not be above twice gate_m: such landmarks share no observation");
  v.flag("split_landmarks", c.split_landmarks,
         "split a landmark where scans show things at two positions at once, time and again");
  v.expert().number("split_distance_m", c.split_distance_m, 0.01, 5, "m",
                    "split_landmarks: least distance of the two positions");
  v.number("observation_range_max_m", c.observation_range_max_m, 0.1, 500, "m",
           "detections farther from base are left out");
  v.expert().flag(
      "align_scans", c.align_scans,
      "decide who is who after fitting the scan to the map, within the pose's covariance");
  v.expert().number("align_kernel_m", c.align_kernel_m, 0.01, 2, "m",
                    "how far from a landmark a detection still supports a fit");
  v.expert().number("centre_kernel_m", c.centre_kernel_m, 0.01, 5, "m",
                    "observations farther than this from the bulk weigh little");
  v.expert().choice(
      "evidence", c.evidence, {"labels", "probability"},
      "what an observation says of a landmark's class: its label, or its calibrated probability");
  v.expert().number("evidence_prior", c.evidence_prior, 0.01, 0.99, "1",
                    "evidence probability: fraction of trees among landmarks");
  v.expert().number(
      "evidence_base_rate", c.evidence_base_rate, 0.01, 0.99, "1",
      "evidence probability: fraction of trees among the observations that were learnt from");
  v.expert().number("evidence_correlation", c.evidence_correlation, 0, 1, "1",
                    "evidence probability: n observations count as n / (1 + (n - 1) x this)");
  v.expert().number("pose_wait_s", c.pose_wait_s, 0, 3600, "s",
                    "message time that detections wait for a pose");
  v.expert().number("pose_gap_max_s", c.pose_gap_max_s, 0.001, 3600, "s",
                    "poses farther apart are not interpolated between");
  v.expert().number("deskew_pose_gap_max_s", c.deskew_pose_gap_max_s, 0, 10, "s",
                    "poses at least this often undo the motion within a scan; 0 = never");
  v.integer("min_observations", c.min_observations, 1, 1000, "1",
            "landmarks seen less often stay out of map files");
  v.section("existence", c.existence, "dropping landmarks that are gone");
  v.section("rows", c.rows, "rows and numbers");
  v.section("album", c.album, "a photograph of each landmark");
  v.check(c.deskew_pose_gap_max_s <= c.pose_gap_max_s, "deskew_pose_gap_max_s",
          "must not be above pose_gap_max_s");
}

}  // namespace orchard::mapping
