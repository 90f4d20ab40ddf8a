// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/detection_evaluation.hpp"

namespace orchard::evaluation {

/// Everything in tables for a terminal. Lines end with a newline.
std::string detection_tables(const DetectionEvaluation& evaluation);

/// The same as one JSON object. Lengths in m.
std::string detection_json(const DetectionEvaluation& evaluation);

/// The same as one HTML page that needs no other file: tables, and as inline SVG the
/// precision-recall curves, the reliability diagram, F1 by range and centre error by range.
std::string detection_page(const DetectionEvaluation& evaluation, const std::string& title);

}  // namespace orchard::evaluation
