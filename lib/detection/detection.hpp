// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::detection {

enum class Label : std::int8_t { kUnseen = 0, kTree = 1, kObject = 2 };

/// Bits for the sides, seen from the laser, on which an object is hidden.
enum Occlusion : std::int8_t { kOccludedRight = 1, kOccludedLeft = 2 };

/// One object detected in a scan and, if possible, judged in an image.
struct Detection {
  std::int64_t utime = 0;    ///< time of its middle beam [us]
  double range_m = 0.0;      ///< to the surface at bearing_rad, laser frame
  double bearing_rad = 0.0;  ///< of its middle, laser frame
  double surface_x_m = 0.0;  ///< base frame
  double surface_y_m = 0.0;
  double centre_x_m = 0.0;  ///< base frame: the trunk's axis
  double centre_y_m = 0.0;
  std::array<double, 3> covariance{};  ///< of the centre in base: xx xy yy [m2]
  double width_m = 0.0;
  double width_sd_m = 0.0;
  float roc_laser = 0.0f;  ///< each roc is in [0, 1], and 0 if its stage was not reached
  float roc_colour = 0.0f;
  float roc_left_edge = 0.0f;
  float roc_right_edge = 0.0f;
  float roc_parallel = 0.0f;
  float roc_edges = 0.0f;
  float roc_vision = 0.0f;
  float roc_tree = 0.0f;
  float probability_tree = 0.0f;    ///< calibrated; at most 1 together with probability_object
  float probability_object = 0.0f;  ///< the remainder to 1 is the probability of unknown
  float intensity = 0.0f;           ///< mean of its beams in the scanner's own unit; 0 = none
  std::int32_t num_beams = 0;
  Label label = Label::kUnseen;
  std::int8_t occlusion = 0;  ///< bits of Occlusion
};

/// All objects of one scan in order of bearing.
struct Detections {
  std::int64_t utime = 0;  ///< of the scan [us]
  std::int32_t seq = 0;
  std::int64_t image_utime = 0;  ///< of the image paired with the scan; 0 = none
  std::vector<Detection> trunks;
};

/// The fields of trunk_v2_t in the order of the wire, or with `kIsFirstRelease` those of trunk_t;
/// see bus/messages/fields.hpp.
template <bool kIsFirstRelease>
struct TrunkFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("range_m", m.range_m, 0, 1e5);
    v.field("bearing_rad", m.bearing_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("surface_x_m", m.surface_x_m, -1e6, 1e6);
    v.field("surface_y_m", m.surface_y_m, -1e6, 1e6);
    v.field("centre_x_m", m.centre_x_m, -1e6, 1e6);
    v.field("centre_y_m", m.centre_y_m, -1e6, 1e6);
    v.covariance("covariance", m.covariance);
    v.field("width_m", m.width_m, 0, 1e5);
    v.field("width_sd_m", m.width_sd_m, 0, 1e5);
    v.field("roc_laser", m.roc_laser, 0, 1);
    v.field("roc_colour", m.roc_colour, 0, 1);
    v.field("roc_left_edge", m.roc_left_edge, 0, 1);
    v.field("roc_right_edge", m.roc_right_edge, 0, 1);
    v.field("roc_parallel", m.roc_parallel, 0, 1);
    v.field("roc_edges", m.roc_edges, 0, 1);
    v.field("roc_vision", m.roc_vision, 0, 1);
    v.field("roc_tree", m.roc_tree, 0, 1);
    if constexpr (!kIsFirstRelease) {
      v.field("probability_tree", m.probability_tree, 0, 1);
      v.field("probability_object", m.probability_object, 0, 1);
      v.field("intensity", m.intensity, 0, 1e9);
    }
    v.field("num_beams", m.num_beams, 0, INT32_MAX);
    v.field("label", m.label, 0, 2);
    v.field("occlusion", m.occlusion, 0, 3);
  }
};

/// The fields of detections_v2_t, or with `kIsFirstRelease` those of detections_t in old logs.
template <bool kIsFirstRelease>
struct DetectionsFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_trunks", m.trunks);
    v.time("image_utime", m.image_utime);
    v.items("trunks", m.trunks, "num_trunks", TrunkFields<kIsFirstRelease>{});
  }
};

inline DetectionsFields<false> fields_of(const Detections&) { return {}; }

/// The name of a label in files and tables: "tree", "object" or "unseen".
inline const char* label_text(Label label) {
  switch (label) {
    case Label::kTree:
      return "tree";
    case Label::kObject:
      return "object";
    case Label::kUnseen:
      break;
  }
  return "unseen";
}

/// roc_edges = (left + right + parallel) / 3. Source: Shalal et al. 2013, figure 9.
inline double fuse_edges(double roc_left_edge, double roc_right_edge, double roc_parallel) {
  return (roc_left_edge + roc_right_edge + roc_parallel) / 3.0;
}

/// roc_vision = w colour + (1 - w) edges. Source: Shalal et al. 2013, section 6.2: w = 0.6 gives
/// the paper's 0.822 from its averages 0.9 and 0.705.
inline double fuse_vision(double roc_colour, double roc_edges, double colour_weight) {
  return colour_weight * roc_colour + (1.0 - colour_weight) * roc_edges;
}

/// roc_tree = w laser + (1 - w) vision. Source: Shalal et al. 2013, figure 4 and table 2 (object
/// B2, whose colour failed: 0.461 = 0.5 x its roc_laser).
inline double fuse_tree(double roc_laser, double roc_vision, double laser_weight) {
  return laser_weight * roc_laser + (1.0 - laser_weight) * roc_vision;
}

/// TREE if roc_tree is at least the threshold, otherwise OBJECT.
inline Label label_of(double roc_tree, double tree_threshold) {
  return roc_tree >= tree_threshold ? Label::kTree : Label::kObject;
}

}  // namespace orchard::detection
