// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/graph/graph.hpp"
#include "pose/slam/coverage.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Finds twins: pairs of landmarks that are one tree, mapped twice because the pose was wrong when
/// the tree was seen again. The less observed landmark is first.
///
/// Twins are nearer to each other than half the spacing of trees that were observed together, have
/// compatible widths and were never observed by the same keyframe, although at least
/// kConfirmKeyframes keyframes of the less observed one should have observed the other. `index`:
/// spatial index of the landmarks. A landmark is the first in at most one pair, and then never the
/// second in another.
std::vector<std::pair<int, int>> find_duplicate_landmarks(const SlamGraph& graph,
                                                          const geometry::PointGrid& index,
                                                          const SensorCoverage& coverage,
                                                          const SlamConfig& config);

}  // namespace orchard::pose
