// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/probability.hpp"
#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"
#include "vision/appearance_config.hpp"
#include "vision/vision_config.hpp"

namespace orchard::detection {

/// Model that computes roc_colour of a window.
enum class ColourModel {
  kHueInterval,  ///< the paper's rule; section `detector.colour`
  kAppearance,   ///< learnt from the rig's own trunks; section `detector.appearance`
};

/// Rule that labels a detection TREE or OBJECT.
enum class Decision {
  kRoc,          ///< the paper's rule: TREE if roc_tree is at least tree_threshold
  kProbability,  ///< TREE if probability_tree is at least detector.probability.tree_min
};

/// Parameters of the detector. Section `detector`.
struct DetectorConfig {
  laser::SegmentationConfig segmentation;
  laser::WidthConfig width;
  vision::WindowConfig window;
  ColourModel colour_model = ColourModel::kHueInterval;
  vision::ColourConfig colour;
  vision::AppearanceConfig appearance;
  vision::EdgeConfig edges;
  static constexpr double kRocLaserMin = laser::kThreeSigmaRoc;  ///< derived: ROC_th
  double visible_fraction_min = 1.0;
  static constexpr double kColourWeight = 0.6;  ///< physical: see fuse_vision()
  static constexpr double kLaserWeight = 0.5;   ///< physical: see fuse_tree()
  double tree_threshold = 0.6;                  ///< min roc_tree of a TREE
  Decision decision = Decision::kRoc;
  ProbabilityConfig probability;
  double pairing_tolerance_s = 0.06;
  double image_wait_s = 0.25;
  /// Compensates the motion from each beam's time to the exposure by ODOMETRY; scans then wait for
  /// ODOMETRY, too.
  bool use_odometry = false;
};

template <class Visitor>
void describe(Visitor& v, DetectorConfig& c) {
  v.section("segmentation", c.segmentation, "segmentation of a scan into objects");
  v.section("width", c.width, "model of trunk widths (eqs. 8-10 of the paper)");
  v.expert().section("window", c.window, "size of the image windows");
  v.choice("colour_model", c.colour_model, {"hue_interval", "appearance"},
           "model for roc_colour: the paper's hue interval, or a learnt appearance model");
  v.section("colour", c.colour, "hue of trunks, for colour_model: hue_interval");
  v.expert().section("appearance", c.appearance,
                     "learnt appearance of trunks, for colour_model: appearance");
  v.check(c.colour_model == ColourModel::kHueInterval || c.appearance.learnt(), "colour_model",
          "needs a learnt detector.appearance; learn one with `orchard calibrate trunks`");
  v.expert().section("edges", c.edges, "detection of trunk edges in the picture");
  v.expert().number(
      "visible_fraction_min", c.visible_fraction_min, 0, 1, "1",
      "min visible fraction of a half-hidden trunk to be classified; its width is estimated from "
      "its circle and detector.width; 1 = half-hidden trunks stay UNSEEN");
  v.number("tree_threshold", c.tree_threshold, 0, 1, "1",
           "min roc_tree of class TREE; a larger value gives fewer, surer trees");
  v.expert().choice("decision", c.decision, {"roc", "probability"},
                    "rule for class TREE: roc_tree at least tree_threshold (the paper), or "
                    "calibrated probability at least probability.tree_min");
  v.expert().section("probability", c.probability, "calibrated probabilities of tree and object");
  v.check(c.decision == Decision::kRoc || c.probability.enabled, "decision",
          "probability needs detector.probability.enabled: true");
  v.check(c.width.mean_m < c.segmentation.width_max_m, "width",
          "mean_m must be below segmentation.width_max_m, otherwise no trunk is reported");
  v.expert().number("pairing_tolerance_s", c.pairing_tolerance_s, 0, 10, "s",
                    "max time difference of a scan and its picture");
  v.expert().number("image_wait_s", c.image_wait_s, 0, 60, "s",
                    "max time that a scan waits for a picture (message time)");
  v.check(c.pairing_tolerance_s <= c.image_wait_s, "pairing_tolerance_s",
          "must not be above image_wait_s, otherwise the picture comes too late");
  v.flag("use_odometry", c.use_odometry,
         "compensate the motion of the robot between beam and picture by ODOMETRY");
}

/// Sensor models, extrinsics and detector parameters of one robot.
struct Rig {
  Rig(const laser::LaserConfig& laser_config, const geometry::CameraConfig& camera_config,
      const DetectorConfig& detector_config)
      : laser(laser_config),
        has_camera(camera_config.enabled),
        camera(camera_config.intrinsics),
        T_camera_laser(camera_config.extrinsics),
        camera_delay_s(camera_config.delay_s),
        detector(detector_config) {}

  laser::LaserConfig laser;
  bool has_camera = true;
  geometry::CameraModel camera;
  geometry::LaserToCamera T_camera_laser;
  double camera_delay_s = 0.0;  ///< exposure = an image's utime - camera_delay_s
  DetectorConfig detector;
};

}  // namespace orchard::detection
