// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws the whole truth and what was compared with it, in axes of equal scale, and below it the
/// position error over the distance that the truth drove. Returns the file.
std::string trajectory_figure(const evaluation::TrajectoryEvaluation& evaluation,
                              const evaluation::Track& truth, FigureFormat format);

}  // namespace orchard::io
