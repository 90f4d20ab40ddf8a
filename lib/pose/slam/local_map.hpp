// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/graph/graph.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Landmarks observed within so much travel are tracked, in sight ranges: a landmark that is passed
/// stays in view over twice the range.
inline constexpr double kRecentTravel_ranges = 2.0;

/// What was observed within so much travel is tracked now, in sight ranges.
inline constexpr double kTrackedTravel_ranges = 0.3;

/// Landmarks whose position against the robot is known well enough to associate single observations
/// with them, ascending: those observed within the last kRecentTravel_ranges of travel of the
/// session, and those covisible with what is tracked now (passed beside it on any pass). Landmarks
/// that are merely near by the map, after a long drift, are left to loop closure. `session_start`
/// is the first keyframe of the session, `range_m` how far landmarks are in sight.
std::vector<int> local_map(const SlamGraph& graph, const geometry::PointGrid& index,
                           int session_start, double range_m, double radius_m);

}  // namespace orchard::pose
