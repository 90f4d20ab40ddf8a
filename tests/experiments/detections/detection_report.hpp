// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "experiments/detections/detection_evaluation.hpp"

namespace orchard::evaluation {

/// The evaluation as tables for a terminal. Lines end with a newline.
std::string detection_tables(const DetectionEvaluation& evaluation);

/// The evaluation as one JSON object. Lengths in m.
std::string detection_json(const DetectionEvaluation& evaluation);

}  // namespace orchard::evaluation
