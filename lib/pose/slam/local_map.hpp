// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/graph/graph.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Travel within which an observed landmark stays in the local map, in sight ranges: a landmark is
/// in view over twice the range while the robot passes it.
inline constexpr double kRecentTravel_ranges = 2.0;

/// Travel within which an observed landmark counts as tracked now, in sight ranges.
inline constexpr double kTrackedTravel_ranges = 0.3;

/// Returns the landmarks, ascending, whose position relative to the robot is certain enough for the
/// association of single observations: those observed within the last kRecentTravel_ranges of
/// travel of the session, and those covisible with tracked ones on any pass. Other nearby landmarks
/// may be displaced by drift and are left to loop closure. `session_start` is the first keyframe of
/// the session, `range_m` the sight range, `radius_m` the search radius about the robot.
std::vector<int> local_map(const SlamGraph& graph, const geometry::PointGrid& index,
                           int session_start, double range_m, double radius_m);

}  // namespace orchard::pose
