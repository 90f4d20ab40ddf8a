// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/graph/graph.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// A reduced graph whose keyframes are the submaps of another graph.
///
/// A submap is rigid, with the present shape of its keyframes' poses. All its observations of a
/// landmark are summed into one from its middle keyframe. The unknowns are the poses of the
/// submaps: far fewer than keyframes, and with less fill-in where a landmark is observed from
/// hundreds of keyframes.
struct SubmapGraph {
  SlamGraph graph;             ///< landmarks have the indices of the original graph
  std::vector<int> keyframes;  ///< per submap: the original keyframe that defines its pose
  std::vector<int> submap_of;  ///< per original keyframe: its submap
};

/// Splits a graph into submaps of at most submap_length_m. A submap also ends where the motion is
/// too uncertain to be rigid.
SubmapGraph submaps_of(const SlamGraph& graph, const SlamConfig& config);

/// Transfers a solved submap graph to the original graph: moves keyframes with their submaps,
/// interpolated by travel between two submaps, moves landmarks, and copies covariances and odometry
/// calibration.
void back_substitute(const SubmapGraph& solved, SlamGraph& graph);

}  // namespace orchard::pose
