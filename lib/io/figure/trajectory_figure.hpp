// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws the ground truth and the compared trajectory in axes of equal scale, and below it the
/// position error over the travelled distance. Returns the file.
std::string trajectory_figure(const evaluation::TrajectoryEvaluation& evaluation,
                              const evaluation::Track& truth, FigureFormat format);

}  // namespace orchard::io
