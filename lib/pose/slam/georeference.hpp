// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pose/slam/graph.hpp"

namespace orchard::pose {

/// T_map_graph that registers a graph to the absolute positions of its keyframes: by the first with
/// a heading, or by positions at least `travel_m` apart (their best rigid fit). None while they do
/// not determine it, or contradict the path by more than a metre and three standard deviations.
std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m);

/// Transforms all keyframes and landmarks of the graph with their covariances.
void apply_georeference(const Eigen::Vector3d& T_map_graph, SlamGraph& graph);

}  // namespace orchard::pose
