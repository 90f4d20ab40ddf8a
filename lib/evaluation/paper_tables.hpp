// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {

/// Tables 1 (trees) and 2 (non-tree objects) of Shalal et al. 2013 as text, with an additional
/// column for the error against truth. The last line of each table has means and RMS. Lengths in
/// mm. Lines end with a newline.
std::string paper_tables(const MapEvaluation& evaluation);

/// Summary for the user in a few lines: objects found, missed, confused and extra, and their
/// errors.
std::string evaluation_summary(const MapEvaluation& evaluation);

/// The whole evaluation as one JSON object. Lengths in m.
std::string evaluation_json(const MapEvaluation& evaluation);

}  // namespace orchard::evaluation
