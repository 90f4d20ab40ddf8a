// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::simulation {

/// One object of the truth, as in a truth CSV (`class,x_m,y_m,width_m`); map frame.
struct TruthObject {
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;
  double y_m = 0.0;
  double width_m = 0.0;
  std::string name;     ///< name in figures (T1, B2); not in the CSV
  bool moving = false;  ///< moving object: only in observations, not in the truth CSV
  double velocity_x_mps = 0.0;
  double velocity_y_mps = 0.0;
};

/// True observation of one object in one scan, as in an observation CSV, from the laser's true pose
/// when its beam passed over the object.
struct TrueObservation {
  std::int64_t utime = 0;  ///< of the scan
  int object = 0;          ///< index in the truth, from 0: the line of the truth CSV
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;                                  ///< map frame, in this scan
  double y_m = 0.0;
  double width_m = 0.0;
  double range_m = 0.0;          ///< to its centre, minus half its width
  double bearing_rad = 0.0;      ///< of its centre, laser frame
  int num_beams = 0;             ///< number of beams whose axes hit it
  double hidden_fraction = 0.0;  ///< fraction of its angular width behind nearer objects
  bool in_picture = false;  ///< its full width, at the height of the scan plane, is in the picture
};

/// True pose of base.
struct TruePose {
  std::int64_t utime = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

}  // namespace orchard::simulation
