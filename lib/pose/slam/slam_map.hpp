// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/slam/graph.hpp"
#include "pose/slam/landmark_index.hpp"
#include "pose/slam/solver.hpp"

namespace orchard::pose {

/// Everything that a solve of the whole graph, and so a loop closure, may change. A closure that
/// the observations refute is undone by assigning the copy from before it: no member can be
/// forgotten.
struct SlamMap {
  SlamGraph graph;
  SlamLandmarkIndex index;
  ErrorsPrior calibration;  ///< of the odometry, by all that was observed until the last solve
  std::vector<int> local;   ///< landmarks that the next scan may show
  int since = 0;            ///< keyframe at which tracking began anew
  int num_solved = 0;       ///< keyframes at the last whole solve
  bool corrected = false;   ///< the past was corrected since it was last published
};

}  // namespace orchard::pose
