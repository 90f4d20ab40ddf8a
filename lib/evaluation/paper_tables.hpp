// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {

/// Tables 1 (trees) and 2 (non-tree objects) of Shalal et al. 2013 as text, each with the column
/// that the paper lacks: the error against truth. A closing line per table gives means and RMS.
/// Lengths in mm. Lines end with a newline.
std::string paper_tables(const MapEvaluation& evaluation);

/// What was found, missed, confused and invented, and how far off, in a few lines for a person.
std::string evaluation_summary(const MapEvaluation& evaluation);

/// The same as everything in evaluation, one JSON object, for programs. Lengths in m.
std::string evaluation_json(const MapEvaluation& evaluation);

}  // namespace orchard::evaluation
