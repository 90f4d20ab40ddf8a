// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/corrected_map.hpp"

namespace orchard::io {

/// Finds a landmark by the user's name for it: its id ("17"), or row and tree ("3/14", the row by
/// number or by name). Throws FileError with one sentence if there is none.
const mapping::Landmark& landmark_named(const CorrectedMapFolder& map, const std::string& name);

/// Position of the gap "3/14". Throws FileError if there is no such gap.
Eigen::Vector2d gap_named(const CorrectedMapFolder& map, const std::string& name);

/// Number of the row with that name. Throws FileError if there is none.
std::int32_t row_named(const CorrectedMapFolder& map, const std::string& name);

/// Describes a landmark: "17 (tree, row 3 tree 14)".
std::string landmark_words(const mapping::Landmark& landmark);

}  // namespace orchard::io
