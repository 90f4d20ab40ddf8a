// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_folder.hpp"

namespace orchard::cli {

/// Prefix of the counts of correction outcomes in the summary.
inline const std::string kCorrectionCount = "corrections_";

/// Throws io::FileError when the output folder has corrections that the earlier map lacks: they
/// would be lost.
void require_corrections_of(const std::string& out_folder, const io::CorrectedMapFolder& earlier);

/// Adds the outcome of the corrections to the summary; each conflict is a warning, there and on
/// stderr. Returns the outcome as one line; empty: no corrections. Does not change the map.
std::string account_corrections(const char* command,
                                const std::vector<mapping::Correction>& corrections,
                                io::MapFolderContent& content);

/// Writes the corrections into the folder.
void write_corrections(const std::string& folder,
                       const std::vector<mapping::Correction>& corrections);

}  // namespace orchard::cli
