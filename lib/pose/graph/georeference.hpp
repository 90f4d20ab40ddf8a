// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// T_map_graph that registers a graph to the absolute positions of its keyframes: by the newest
/// with a heading, or by the newest positions that lie `travel_m` apart and far beside their noise
/// (their best rigid fit, the path with its drift and all before left aside). None while they do
/// not determine it, or more than a few contradict the path by a metre and three standard
/// deviations.
std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m);

/// Transforms all keyframes and landmarks of the graph with their covariances.
void apply_georeference(const Eigen::Vector3d& T_map_graph, SlamGraph& graph);

/// Adds a position to the newest keyframe; one by satellites with the receiver's error of its time.
void add_position(AbsolutePosition position, SlamGraph& graph);

/// How much of what the receiver claims is noise of each fix, and how much an error that lasts, by
/// the steps between its fixes against the path. As claimed before there are enough.
ReceiverModel judge_receiver(const SlamGraph& graph);

/// Satellite fixes that the solved path does not bear out.
struct FixesLeftOut {
  int num_fixes = 0;  ///< all of them
  int num_left_out = 0;
  double farthest_m = 0.0;
  double longest_s = 0.0;  ///< from the first to the last of those left out in a row
};
FixesLeftOut fixes_left_out(const SlamGraph& graph);

/// For people; empty where none was.
std::string in_words(const FixesLeftOut& left_out);

}  // namespace orchard::pose
