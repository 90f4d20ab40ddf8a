// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::simulation {

/// One thing of the true world, as a truth CSV (`class,x_m,y_m,width_m`) states it: map frame.
struct TruthObject {
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;
  double y_m = 0.0;
  double width_m = 0.0;
  std::string name;     ///< as figures show it (T1, B2); not in the CSV
  bool moving = false;  ///< walks: in no truth CSV, only in observations
  double velocity_x_mps = 0.0;
  double velocity_y_mps = 0.0;
};

/// One thing of the true world in one scan, as an observation CSV states it. Seen from where the
/// laser truly was when its beam passed over the thing.
struct TrueObservation {
  std::int64_t utime = 0;  ///< of the scan
  int object = 0;          ///< place in the truth, from 0: the line of the truth CSV
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;                                  ///< map frame, in this scan
  double y_m = 0.0;
  double width_m = 0.0;
  double range_m = 0.0;          ///< to its middle, less half its width
  double bearing_rad = 0.0;      ///< of its middle, laser frame
  int num_beams = 0;             ///< whose axes truly hit it
  double hidden_fraction = 0.0;  ///< fraction of its angular width behind nearer things
  bool in_picture = false;       ///< its full width, at the height of the scan plane
};

/// Where base truly was.
struct TruePose {
  std::int64_t utime = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

}  // namespace orchard::simulation
