// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/corrected_map.hpp"

namespace orchard::io {

/// The landmark that people call so: its id ("17"), or row and tree ("3/14", the row by number or
/// by name). Throws FileError in one sentence when there is none.
const mapping::Landmark& landmark_named(const CorrectedMapFolder& map, const std::string& name);

/// Where the gap "3/14" lies. Throws FileError when there is no such gap.
Eigen::Vector2d gap_named(const CorrectedMapFolder& map, const std::string& name);

/// The number of a row that is called so; throws FileError when there is none.
std::int32_t row_named(const CorrectedMapFolder& map, const std::string& name);

/// "17 (tree, row 3 tree 14)": a landmark in words.
std::string landmark_words(const mapping::Landmark& landmark);

}  // namespace orchard::io
