// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/localisation_evaluation.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws the error of a localisation and twice its claimed standard deviation over time; grey where
/// it is lost, yellow where it is ambiguous. The error axis ends at 2 m, or at the largest error
/// below it; what is above is drawn at its end. Returns the file.
std::string localisation_figure(const evaluation::LocalisationEvaluation& evaluation,
                                const std::string& title, FigureFormat format);

}  // namespace orchard::io
