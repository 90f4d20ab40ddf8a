// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/compare/map_merging.hpp"

namespace orchard::cli {

/// An input map of a command: with its manual corrections, or as mapped.
struct MapInput {
  io::StoredMap mapped;  ///< the measured map, used to register maps
  io::StoredMap map;     ///< the map with the corrected landmarks
  std::map<std::int32_t, std::string> row_names;
};

/// Prints the number of conflicting corrections on stderr, prefixed by `command`; `path`: the
/// map's.
void warn_of_conflicts(const char* command, const std::string& path,
                       const mapping::CorrectedMap& corrected);

/// Reads a map folder with its corrections, unless `as_mapped`, or a map.csv alone. Prints the
/// number of conflicting corrections on stderr, prefixed by `command`. Throws io::FileError.
MapInput read_map_input(const char* command, const std::string& path, bool as_mapped);

/// The folder of a map, which is given by its folder or its map.csv.
std::filesystem::path map_folder_of(const std::string& map_path);

/// The name of a map: that of its folder, as text that can be printed.
std::string map_name(const std::string& map_path);

/// Detection-probability map of a map's drives; `reach_m` above 0 replaces the range stored in the
/// map.
mapping::DetectionMap view_of(const io::StoredMap& map, double reach_m);

/// Registers map b to map a. Throws io::FileError in one sentence when the registration fails or is
/// ambiguous.
mapping::MapAlignment register_map(const io::StoredMap& a, const mapping::DetectionMap& view_a,
                                   const io::StoredMap& b, const mapping::DetectionMap& view_b,
                                   const mapping::MapAlignmentConfig& config);

/// Registers the measured maps. The pairs are those of the corrected landmarks.
mapping::MapAlignment register_map(const MapInput& a, const mapping::DetectionMap& view_a,
                                   const MapInput& b, const mapping::DetectionMap& view_b,
                                   const mapping::MapAlignmentConfig& config);

/// The facts of a map's summary.json, with the names of this program's channels.
io::SummaryFacts facts_of(const std::string& map_path);

/// An earlier map, and what became of its trees.
struct ComparedMaps {
  MapInput before;
  mapping::MapAlignment alignment;      ///< a: the earlier map
  mapping::MapComparison comparison{};  ///< of the corrected landmarks
};

/// Compares a map with an earlier one. Throws io::FileError for a map without a path, and like
/// register_map().
ComparedMaps compare_with_earlier(const char* command, const std::string& previous_path,
                                  const std::string& map_path, const MapInput& now, bool as_mapped,
                                  const mapping::MapAlignmentConfig& config);

/// Data that a new map keeps from an earlier one.
struct EarlierIdentity {
  mapping::IdTransfer numbers;
  std::vector<mapping::Correction> corrections;  ///< of the earlier map, converted to the new one
};

/// Gives landmarks of `content` that match an earlier map their ids, numbers and the plan's names
/// there, and notes it in the summary. Manual additions to the earlier map count as known. The
/// caller makes rows and ways again from the numbers. Throws like register_map().
EarlierIdentity transfer_identity(const io::CorrectedMapFolder& earlier,
                                  const mapping::MapAlignmentConfig& config,
                                  io::MapFolderContent& content);

/// Throws io::FileError when `out_folder` holds one of the inputs (a map folder or a map.csv).
void require_other_folder(const std::string& out_folder, const std::vector<std::string>& inputs);

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

/// Converts a stored map to the content of a new folder: landmarks, paths, coverage, georeference;
/// without rows. Maps store no beams: the area beside a driven path counts as seen free.
io::MapFolderContent content_of(io::StoredMap map);

/// The same content's summary: this program's version, and the times of the paths.
io::MapSummary summary_of(const io::StoredMap& map);

/// The same content's free space: the area beside the paths; none without paths.
mapping::FreeSpaceTest seen_free_of(const io::StoredMap& map);

}  // namespace orchard::cli
