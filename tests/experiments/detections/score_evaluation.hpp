// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "experiments/detections/detection_evaluation.hpp"

namespace orchard::evaluation {

/// True if an observation's true object counts under the rules: near, visible and with enough
/// beams.
bool counts(const ObservationPair& observation, const DetectionRules& rules);

/// True if counts() and the object is a tree.
bool counts_as_tree(const ObservationPair& observation, const DetectionRules& rules);

/// Adds one observation, classified as a tree or not, to the counts. TREE on a tree that does not
/// count is neither right nor wrong; TREE on any other object is wrong, however much it is hidden.
void count_observation(const ObservationPair& observation, bool is_called_tree,
                       const DetectionRules& rules, Counts& counts);

/// Evaluates each score alone: the paper's three tests (colour, edges, both; section 6.2), laser
/// only, all (roc_tree) and, where available, the calibrated probability.
///
/// A stage that was not reached because an earlier one failed has score 0, which no threshold
/// accepts as a tree: edges are searched only on objects with a trunk's colour.
std::vector<ScoreTest> score_tests(const std::vector<ObservationPair>& observations,
                                   const DetectionRules& rules);

}  // namespace orchard::evaluation
