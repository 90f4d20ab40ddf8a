// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/graph/graph.hpp"
#include "pose/slam/coverage.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Pairs of landmarks (the less observed first) that are one tree: mapped twice because the robot
/// was off where it was seen again.
///
/// They stand nearer to each other than half of what trees do that were seen side by side, are
/// alike in width, were never seen from one place, and of the less observed one's keyframes so many
/// should have seen the other as make a landmark. `index`: of the landmarks. Each landmark is in
/// one pair at most as the first, and never in one as both.
std::vector<std::pair<int, int>> find_twins(const SlamGraph& graph,
                                            const geometry::PointGrid& index,
                                            const SensorCoverage& coverage,
                                            const SlamConfig& config);

}  // namespace orchard::pose
