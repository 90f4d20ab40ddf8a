// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluation/detections/detection_evaluation.hpp"

namespace orchard::evaluation {

/// Whether an observation's true thing is near, whole and visible enough to be asked for.
bool counts(const ObservationPair& observation, const DetectionRules& rules);

/// counts(), and it is a tree.
bool counts_as_tree(const ObservationPair& observation, const DetectionRules& rules);

/// Adds one observation, called a tree or not, to the counts. A call on a tree that does not count
/// is neither right nor wrong; one on anything else is wrong however hidden that is.
void count_observation(const ObservationPair& observation, bool is_called_tree,
                       const DetectionRules& rules, Counts& counts);

/// The paper's three tests (colour, edges, both; section 6.2), laser only, everything (roc_tree)
/// and, where there are any, the calibrated probability: each by its own score alone.
///
/// A stage that an earlier one kept from being reached leaves 0, which no threshold takes for a
/// tree: edges are asked only of what has a trunk's colour.
std::vector<ScoreTest> score_tests(const std::vector<ObservationPair>& observations,
                                   const DetectionRules& rules);

}  // namespace orchard::evaluation
