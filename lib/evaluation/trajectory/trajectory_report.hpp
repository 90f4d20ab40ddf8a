// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::evaluation {

/// A trajectory's figures in a few lines for a person; metres and degrees.
std::string trajectory_summary(const TrajectoryEvaluation& evaluation,
                               const TrajectoryRules& rules);

/// The same as one JSON object for programs; metres and radians.
std::string trajectory_json(const TrajectoryEvaluation& evaluation, const TrajectoryRules& rules);

}  // namespace orchard::evaluation
