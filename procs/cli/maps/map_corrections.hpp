// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_folder.hpp"

namespace orchard::cli {

/// Before the names of what became of corrections, among the counts.
inline const std::string kCorrectionCount = "corrections_";

/// Throws io::FileError when the folder that a map is to be written into holds corrections that the
/// earlier map has not: they would be lost.
void require_corrections_of(const std::string& out_folder, const io::CorrectedMapFolder& earlier);

/// Says in the summary what becomes of corrections on the map; each conflict is a warning, there
/// and on stderr. Returns it in a line; empty: there are none. The map stays as it is.
std::string account_corrections(const char* command,
                                const std::vector<mapping::Correction>& corrections,
                                io::MapFolderContent& content);

/// Makes them the folder's corrections.
void write_corrections(const std::string& folder,
                       const std::vector<mapping::Correction>& corrections);

}  // namespace orchard::cli
