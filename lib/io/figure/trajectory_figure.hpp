// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory_evaluation.hpp"

namespace orchard::io {

/// A trajectory and what is true: the two paths, and the error over the distance driven.
struct TrajectoryFigure {
  std::string svg;
  std::string png;
};

/// Draws the whole truth and what was compared with it, in axes of equal scale, and below it the
/// position error over the distance that the truth drove.
TrajectoryFigure draw_trajectory(const evaluation::TrajectoryEvaluation& evaluation,
                                 const evaluation::Track& truth);

}  // namespace orchard::io
