// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/map/stored_map.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::io {

/// A map folder as people know it: what was mapped, and the corrections beside it.
struct CorrectedMapFolder {
  StoredMap mapped;  ///< as the run left it
  std::vector<mapping::Correction> corrections;
  std::size_t num_unfinished_bytes = 0;  ///< StoredCorrections
  mapping::CorrectedMap corrected;       ///< without corrections: as it was mapped
  std::vector<mapping::Row> rows;        ///< of the corrected map; none where it has no numbers
};

/// Reads a map folder (or a map.csv alone) with its corrections, unless `as_mapped`. What was added
/// by hand in a row gets that row and the number of its place. Throws FileError.
CorrectedMapFolder read_corrected_map(const std::string& folder_or_csv, bool as_mapped = false);

/// The same with a list of corrections in place of those beside the map.
CorrectedMapFolder corrected_map_of(StoredMap mapped, std::vector<mapping::Correction> corrections);

/// "3 applied, 1 conflict": what became of the corrections, in words; "none" of none.
std::string corrections_text(const mapping::CorrectedMap& corrected);

}  // namespace orchard::io
