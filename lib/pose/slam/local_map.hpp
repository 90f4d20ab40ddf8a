// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/slam/graph.hpp"
#include "pose/slam/landmark_index.hpp"
#include "pose/slam/slam_config.hpp"

namespace orchard::pose {

/// The landmarks whose place against the robot is known well enough to match single sightings to
/// them, ascending: those seen within the last recent_travel_m, and those that were passed together
/// with what is being tracked now (within covisible_travel_m of path of it, on any pass). What
/// merely lies near by the map, but was last seen a long drift ago, is left to loop closure.
/// `since` is the keyframe before which nothing counts as recent (where tracking was lost).
std::vector<int> local_map(const SlamGraph& graph, const SlamLandmarkIndex& index, int since,
                           double radius_m, const SlamConfig& config);

}  // namespace orchard::pose
