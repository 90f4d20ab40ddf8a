// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/slam/graph.hpp"
#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// A graph whose keyframes are stretches of the path of another one.
///
/// A stretch keeps the shape that the corrections of the last keyframes gave it; all that it saw of
/// a landmark is summed up as one sighting from its middle, as the scans of a keyframe are. What is
/// left to find is how the stretches lie to each other: as many unknowns less as a stretch has
/// keyframes, and far less fill where a landmark is seen from hundreds of them.
struct StretchGraph {
  SlamGraph graph;              ///< landmarks have the indices that they have in the other
  std::vector<int> keyframes;   ///< of the other: where each stretch has its pose
  std::vector<int> stretch_of;  ///< per keyframe of the other
};

/// The stretches of a graph, solve_stretch_m long at most. What only blind and uncertain motion
/// joins is in no stretch together.
StretchGraph stretches_of(const SlamGraph& graph, const SlamConfig& config);

/// Lays the path upon the corrected stretches: between the poses of two, by both of them; with
/// their covariances, and the landmarks' places.
void take_over(const StretchGraph& solved, SlamGraph& graph);

}  // namespace orchard::pose
