// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/detections/detection_evaluation.hpp"
#include "evaluation/plot.hpp"

namespace orchard::evaluation {

/// The evaluation as tables for a terminal. Lines end with a newline.
std::string detection_tables(const DetectionEvaluation& evaluation);

/// The evaluation as one JSON object. Lengths in m.
std::string detection_json(const DetectionEvaluation& evaluation);

/// Plots: precision-recall curves, the reliability diagram where there are probabilities, precision
/// and recall by range, centre error by range.
std::vector<Plot> detection_plots(const DetectionEvaluation& evaluation);

}  // namespace orchard::evaluation
