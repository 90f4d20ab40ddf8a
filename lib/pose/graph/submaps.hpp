// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/graph/graph.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// A graph whose keyframes are the submaps of another graph.
///
/// A submap is rigid, with the shape that the corrections of its keyframes gave it; all its
/// observations of a landmark are summed into one from its middle keyframe. The unknowns are the
/// poses of the submaps: fewer by the keyframes of a submap, and with far less fill where a
/// landmark is observed from hundreds of keyframes.
struct SubmapGraph {
  SlamGraph graph;             ///< landmarks have the indices of the other graph
  std::vector<int> keyframes;  ///< of the other graph: the keyframe whose pose a submap has
  std::vector<int> submap_of;  ///< per keyframe of the other graph
};

/// The submaps of a graph, at most submap_length_m long. A submap ends where the motion is
/// uncertain.
SubmapGraph submaps_of(const SlamGraph& graph, const SlamConfig& config);

/// Moves keyframes and landmarks with their solved submaps, between two submaps in proportion to
/// the travel; takes over covariances and odometry calibration.
void back_substitute(const SubmapGraph& solved, SlamGraph& graph);

}  // namespace orchard::pose
