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
  std::string name;  ///< as figures show it (T1, B2); not in the CSV
};

/// Where base truly was.
struct TruePose {
  std::int64_t utime = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

}  // namespace orchard::simulation
