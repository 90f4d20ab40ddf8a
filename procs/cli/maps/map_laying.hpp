// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/map/corrected_map.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/rows/number_keeping.hpp"

namespace orchard::cli {

/// Where the drives of a map looked; `reach_m` over 0 replaces what the map says.
mapping::DetectionMap view_of(const io::StoredMap& map, double reach_m);

/// How map b lies on map a. Throws io::FileError in one sentence when that cannot be told.
mapping::MapAlignment lay_on(const io::StoredMap& a, const mapping::DetectionMap& view_a,
                             const io::StoredMap& b, const mapping::DetectionMap& view_b,
                             const mapping::MapAlignmentConfig& config);

/// What a new map has of an earlier one.
struct KeptMap {
  mapping::KeptNumbers numbers;
  std::vector<mapping::Correction> corrections;  ///< of the earlier map, as of the new one
};

/// Gives what `content` has in common with an earlier map the ids and numbers it had there, and
/// says so in its summary. What people added to the earlier one counts as known. Throws as
/// lay_on().
KeptMap keep_known(const io::CorrectedMapFolder& earlier, const mapping::MapAlignmentConfig& config,
                   const mapping::RowsConfig& rows, io::MapFolderContent& content);

/// Throws io::FileError when `out_folder` holds one of the inputs (a map folder or a map.csv).
void require_other_folder(const std::string& out_folder, const std::vector<std::string>& inputs);

}  // namespace orchard::cli
