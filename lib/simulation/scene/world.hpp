// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::simulation {

/// One object of the truth, as in a truth CSV (`class,x_m,y_m,width_m`, optionally `z_m`); map
/// frame.
struct TruthObject {
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;
  double y_m = 0.0;
  double width_m = 0.0;
  std::string name;     ///< name in figures (T1, B2); not in the CSV
  bool moving = false;  ///< moving object: not in the truth CSV
  double velocity_x_mps = 0.0;
  double velocity_y_mps = 0.0;
  double z_m = 0.0;  ///< of the ground beneath it; in the CSV where the ground is not flat
};

/// True pose of base in map; z, roll and pitch are 0 on level ground.
struct TruePose {
  std::int64_t utime = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double z_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

}  // namespace orchard::simulation
