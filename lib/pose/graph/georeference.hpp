// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

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

/// Statistics of the fixes that contradict the solved path.
struct RejectedFixes {
  int num_fixes = 0;  ///< all fixes
  int num_left_out = 0;
  int num_contradicting = 0;        ///< of those that were not known to be displaced
  bool newest_contradicts = false;  ///< of the same
  double farthest_m = 0.0;
  double longest_s = 0.0;  ///< longest time from the first to the last of consecutive ones
};
/// Counts the fixes of the receiver, or else those of POSE_FIX.
RejectedFixes rejected_fixes(const SlamGraph& graph, bool of_receiver = true);

/// Formats the statistics for the user; empty if no fix was left out.
std::string rejected_fixes_text(const RejectedFixes& left_out, bool of_receiver = true);

/// Splits the receiver's variance into white noise and a time-correlated error, by comparing the
/// steps between its fixes with the path: what the steps do not show of the claimed variance is
/// correlated, unless the drive has shown its variance. White noise as claimed if there are too few
/// steps.
ReceiverModel estimate_receiver_model(const SlamGraph& graph);

/// Returns the variance of the time-correlated error relative to the claimed one, by the fixes'
/// distances from a solved path: a receiver may claim more or less than its slow error.
/// `claimed` is the relative variance before any evidence; it counts as one independent fix.
/// `variances` are the posterior variances of SlamGraph::receiver_errors per axis [m2], negative
/// where unknown. Source: the M step of the EM algorithm for the variance of a Gauss-Markov process
/// (Dempster, Laird, Rubin 1977), with the weights of the solver's robust loss.
double learnt_receiver_variance(const SlamGraph& graph, double claimed,
                                const std::vector<double>& variances);

/// Returns a warning for the user if the drive shows more than twice the standard deviation that
/// the receiver claims; else empty.
std::string receiver_text(const SlamGraph& graph);

}  // namespace orchard::pose
