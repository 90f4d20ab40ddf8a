// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Finds T_map_graph, which registers a graph to the absolute positions of its keyframes: by the
/// newest position with a heading, or by a robust rigid fit to the newest positions that spread
/// over `travel_m` and far more than their noise. Older positions are not used because the path
/// drifts. None while the positions do not determine it, or if more than a fifth contradict the
/// path by more than a metre plus three standard deviations.
std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m);

/// Transforms all keyframes and landmarks of the graph with their covariances.
void apply_georeference(const Eigen::Vector3d& T_map_graph, SlamGraph& graph);

/// Adds a position to the newest keyframe; assigns the receiver's error of its time to one by GNSS.
void add_position(AbsolutePosition position, SlamGraph& graph);

/// Returns the claimed variance of a position per axis [m2].
double per_axis_variance(const AbsolutePosition& position);

/// Returns the measured point's position in map as estimated by the path [m].
Eigen::Vector2d p_by_path(const Keyframe& keyframe, const AbsolutePosition& position);

/// Statistics of the GNSS fixes that contradict the solved path.
struct RejectedFixes {
  int num_fixes = 0;  ///< all fixes
  int num_left_out = 0;
  int num_contradicting = 0;        ///< of those that were not known to be displaced
  bool newest_contradicts = false;  ///< of the same
  double farthest_m = 0.0;
  double longest_s = 0.0;  ///< longest time from the first to the last of consecutive ones
};
RejectedFixes rejected_fixes(const SlamGraph& graph);

/// Formats the statistics for the user; empty if no fix was left out.
std::string rejected_fixes_text(const RejectedFixes& left_out);

}  // namespace orchard::pose
