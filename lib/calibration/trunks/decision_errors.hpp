// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/probability_learner.hpp"

namespace orchard::calibration {

/// Wrong decisions on the same labelled detections.
struct DecisionErrors {
  int num = 0;          ///< detections that are labelled
  int roc = 0;          ///< wrong with decision: roc
  int probability = 0;  ///< wrong with decision: probability, by weights fitted without them
};

/// Compares both decisions of the detector. `samples` are detections of a detector with decision:
/// roc, `fit` what learn_probability() made of them. What is UNSEEN is so with either.
DecisionErrors decision_errors(const std::vector<ProbabilitySample>& samples,
                               const ProbabilityFit& fit);

}  // namespace orchard::calibration
