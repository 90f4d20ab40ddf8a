// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/filter/displacement_histories.hpp"
#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Marks the positions within these times, ascending; all others are direct.
void mark_displaced(const std::vector<DisplacedTime>& displaced, SlamGraph& graph);

/// Marks the fixes of a georeferenced graph that are displaced, e.g. by reflected signals, by their
/// distances from its path: FixHypotheses decides, for a robot that stands at the constant distance
/// of the map from the receiver's frame. The path must err slowly compared with a displacement.
void mark_displaced_fixes(SlamGraph& graph);

}  // namespace orchard::pose
