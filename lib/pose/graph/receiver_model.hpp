// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

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
