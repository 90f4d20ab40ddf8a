// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

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

}  // namespace orchard::detection
