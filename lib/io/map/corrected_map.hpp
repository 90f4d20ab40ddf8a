// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/map/stored_map.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::io {

/// A map folder with the manual corrections: the map of the run and the corrected map.
struct CorrectedMapFolder {
  StoredMap mapped;  ///< the map as the run wrote it
  std::vector<mapping::Correction> corrections;
  std::size_t num_unfinished_bytes = 0;  ///< as in StoredCorrections
  mapping::CorrectedMap corrected;  ///< equal to the map of the run if there are no corrections
  std::vector<mapping::Row> rows;   ///< of the corrected map; empty without row numbers
  mapping::NavigationGraph graph;   ///< of the corrected map
};

/// Reads a map folder (or a map.csv alone) and applies its corrections, unless `as_mapped`.
///
/// A correction changes what it touches: a tree added within a row gets this row and its position
/// number, and ways become narrower beside what was added or moved. Throws FileError.
CorrectedMapFolder read_corrected_map(const std::string& folder_or_csv, bool as_mapped = false);

/// The same with a given list of corrections instead of the file's.
CorrectedMapFolder corrected_map_of(StoredMap mapped, std::vector<mapping::Correction> corrections);

/// Summarizes the result of the corrections: "3 applied, 1 conflict"; "none" if there are none.
std::string corrections_text(const mapping::CorrectedMap& corrected);

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
