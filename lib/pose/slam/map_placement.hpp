// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pose/slam/graph.hpp"

namespace orchard::pose {

/// T_map_graph that lays a graph onto the fixes of its keyframes: from the first fix with a
/// heading, or from positions at least `travel_m` apart (their best rigid fit). None while they do
/// not tell, or contradict the path by more than a metre and three standard deviations.
std::optional<Eigen::Vector3d> placement(const SlamGraph& graph, double travel_m);

/// Moves everything in the graph: keyframes with their covariances, and landmarks.
void place(SlamGraph& graph, const Eigen::Vector3d& T_map_graph);

}  // namespace orchard::pose
