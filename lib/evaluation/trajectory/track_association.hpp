// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::evaluation {

/// Longest interval between true poses that is interpolated across when nothing is said: three
/// times the median interval [s]; 0 for fewer than two poses.
double usual_gap_s(const Track& truth);

/// Pairs estimates with the truth by time: fills `compared` (estimate and truth, not the errors),
/// gap_max_s and the numbers of what found no partner.
void associate(const Track& estimate, const Track& truth, const TrajectoryRules& rules,
               TrajectoryEvaluation& evaluation);

}  // namespace orchard::evaluation
