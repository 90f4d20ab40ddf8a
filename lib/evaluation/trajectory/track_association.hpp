// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::evaluation {

/// Default of the max interval between true poses for interpolation: three times the median
/// interval [s]; 0 for fewer than two poses.
double median_gap_s(const Track& truth);

/// Pairs estimates with the truth by time: fills `compared` (estimate and truth, not the errors),
/// gap_max_s and the numbers of unpaired poses.
void associate(const Track& estimate, const Track& truth, const TrajectoryRules& rules,
               TrajectoryEvaluation& evaluation);

}  // namespace orchard::evaluation
