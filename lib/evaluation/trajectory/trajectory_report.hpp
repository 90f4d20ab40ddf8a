// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::evaluation {

/// The evaluation as a few lines for the user; metres and degrees.
std::string trajectory_summary(const TrajectoryEvaluation& evaluation,
                               const TrajectoryRules& rules);

/// The evaluation as one JSON object; metres and radians.
std::string trajectory_json(const TrajectoryEvaluation& evaluation, const TrajectoryRules& rules);

}  // namespace orchard::evaluation
