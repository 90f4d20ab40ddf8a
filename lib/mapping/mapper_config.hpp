// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// Configuration of the existence filter, section `mapper.existence`.
struct ExistenceConfig {
  double period_s = 0.25;    ///< min time between two scans that are used
  double scan_wait_s = 1.0;  ///< message time that DETECTIONS wait for their SCAN; 0 = not used
};

template <class Visitor>
void describe(Visitor& v, ExistenceConfig& c) {
  v.expert().number("period_s", c.period_s, 0.0, 60.0, "s",
                    "min time between two scans that are used (message time)");
  v.expert().number("scan_wait_s", c.scan_wait_s, 0.0, 60.0, "s",
                    "max time that DETECTIONS wait for their SCAN (message time); 0 = do not use "
                    "SCAN, no landmark is removed");
}

/// Configuration of the album, section `mapper.album`.
struct AlbumConfig {
  double max_mb = 8.0;  ///< limit on all photographs; 0: none are kept
};

template <class Visitor>
void describe(Visitor& v, AlbumConfig& c) {
  v.expert().number("max_mb", c.max_mb, 0, 1000, "MB",
                    "max size of all photographs of trees and objects; 0 = no photographs");
}

/// Source of the class evidence of an observation.
enum class Evidence {
  kLabels,       ///< its label, by the rates of TreeRates
  kProbability,  ///< its calibrated probability_tree
};

/// Configuration of the mapper, section `mapper`.
struct MapperConfig {
  double gate_m = 0.30;        ///< max distance of a detection from its landmark
  double gate_sigma = 3.5;     ///< the same in standard deviations of detection, pose and landmark
  double width_gate_m = 0.25;  ///< max width difference of a detection and its landmark
  double merge_m = 0.10;       ///< landmarks closer than this are merged
  double observation_range_max_m = 100.0;  ///< farther detections are left out (range from base)
  bool align_scans = true;                 ///< align each scan with the map before association
  double align_kernel_m = 0.15;   ///< detections farther from a landmark support the fit little
  double centre_kernel_m = 0.20;  ///< kernel of the mode; observations farther from it weigh little
  Evidence evidence = Evidence::kLabels;
  double evidence_prior = 0.5;        ///< fraction of trees among landmarks
  double evidence_base_rate = 0.5;    ///< fraction of trees among the calibration's observations
  double evidence_correlation = 0.2;  ///< of two observations of a landmark, given its class
  double pose_wait_s = 10.0;          ///< message time that DETECTIONS wait for a POSE
  double pose_gap_max_s = 2.0;        ///< no interpolation across larger gaps between poses
  /// With poses at least this often, each detection is placed at its own beam's time; with sparser
  /// poses, all detections of a scan at the time of its first beam (a robot measured at stops does
  /// not move while it scans).
  double deskew_pose_gap_max_s = 0.25;
  int min_observations = 1;  ///< landmarks with fewer are left out of map files
  /// Not a key of its own: detector.segmentation.min_beams. Objects hit by fewer beams are not
  /// detected.
  int min_beams = 1;
  /// Not a key of its own: detector.segmentation.width_max_m. Wider objects are not reported whole.
  double object_width_max_m = 2.0;
  /// Not a key of its own: camera.enabled.
  bool has_camera = true;
  /// Not a key of its own: true if detector.segmentation.reflector is `only`, so that TREE means a
  /// reflector was seen.
  bool reflector_marks_tree = false;
  ExistenceConfig existence;
  AlbumConfig album;
  RowsConfig rows;

  /// Whether a label tells no more than whether a width fits a trunk: by a laser alone.
  bool judges_by_width() const {
    return evidence == Evidence::kLabels && !has_camera && !reflector_marks_tree;
  }
};

template <class Visitor>
void describe(Visitor& v, MapperConfig& c) {
  v.number("gate_m", c.gate_m, 0.01, 0.99, "m",
           "max distance of a detection from its landmark; larger tolerates worse poses, but mixes "
           "up neighbours");
  v.expert().number("gate_sigma", c.gate_sigma, 0.5, 20, "1",
                    "max distance of a detection from its landmark in standard deviations of both "
                    "and of the pose");
  v.expert().number("width_gate_m", c.width_gate_m, 0.01, 10, "m",
                    "max difference of the widths of a detection and its landmark");
  v.expert().number("merge_m", c.merge_m, 0, 0.99, "m", "landmarks nearer than this are merged");
  v.check(c.merge_m <= 2.0 * c.gate_m, "merge_m",
          "must not be above twice gate_m: landmarks farther apart share no observation");
  v.expert().number("observation_range_max_m", c.observation_range_max_m, 0.1, 500, "m",
                    "max range of detections from base; farther ones are ignored");
  v.expert().flag(
      "align_scans", c.align_scans,
      "align each scan with the map, within the covariance of the pose, before association");
  v.expert().number("align_kernel_m", c.align_kernel_m, 0.01, 2, "m",
                    "align_scans: standard deviation of the Gaussian weight of a detection's "
                    "distance from a landmark");
  v.expert().number("centre_kernel_m", c.centre_kernel_m, 0.01, 5, "m",
                    "standard deviation of the Gaussian kernel of a landmark's position; "
                    "observations farther from the mode weigh little");
  v.expert().choice("evidence", c.evidence, {"labels", "probability"},
                    "class evidence of an observation: its label, or its calibrated probability");
  v.expert().number("evidence_prior", c.evidence_prior, 0.01, 0.99, "1",
                    "evidence: probability: fraction of trees among landmarks; from `orchard "
                    "calibrate trunks`");
  v.expert().number(
      "evidence_base_rate", c.evidence_base_rate, 0.01, 0.99, "1",
      "evidence: probability: fraction of trees among the observations of the calibration");
  v.expert().number("evidence_correlation", c.evidence_correlation, 0, 1, "1",
                    "evidence: probability: correlation c of observations; n of them count as n / "
                    "(1 + (n - 1) c)");
  v.expert().number("pose_wait_s", c.pose_wait_s, 0, 3600, "s",
                    "max time that DETECTIONS wait for a POSE (message time)");
  v.expert().number("pose_gap_max_s", c.pose_gap_max_s, 0.001, 3600, "s",
                    "max interval of poses to interpolate between");
  v.expert().number(
      "deskew_pose_gap_max_s", c.deskew_pose_gap_max_s, 0, 10, "s",
      "max interval of poses to compensate the motion within a scan; 0 = never compensate");
  v.integer("min_observations", c.min_observations, 1, 1000, "1",
            "min observations of a landmark in the map files; larger drops clutter and rarely seen "
            "trees");
  v.section("existence", c.existence, "removal of landmarks that are gone");
  v.section("rows", c.rows, "rows of trees and their numbers");
  v.section("album", c.album, "photographs of landmarks");
  v.check(c.deskew_pose_gap_max_s <= c.pose_gap_max_s, "deskew_pose_gap_max_s",
          "must not be above pose_gap_max_s");
}

}  // namespace orchard::mapping
