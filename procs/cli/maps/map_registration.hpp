// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/map/corrected_map.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/compare/map_merging.hpp"

namespace orchard::cli {

/// Detection-probability map of a map's drives; `reach_m` above 0 replaces the range stored in the
/// map.
mapping::DetectionMap view_of(const io::StoredMap& map, double reach_m);

/// Registers map b to map a. Throws io::FileError in one sentence when the registration fails or is
/// ambiguous.
mapping::MapAlignment register_map(const io::StoredMap& a, const mapping::DetectionMap& view_a,
                                   const io::StoredMap& b, const mapping::DetectionMap& view_b,
                                   const mapping::MapAlignmentConfig& config);

/// Data that a new map keeps from an earlier one.
struct EarlierIdentity {
  mapping::IdTransfer numbers;
  std::vector<mapping::Correction> corrections;  ///< of the earlier map, converted to the new one
};

/// Gives landmarks of `content` that match an earlier map their ids and numbers there, and notes it
/// in the summary. Manual additions to the earlier map count as known. The caller makes rows and
/// ways again from the numbers. Throws like register_map().
EarlierIdentity transfer_identity(const io::CorrectedMapFolder& earlier,
                                  const mapping::MapAlignmentConfig& config,
                                  io::MapFolderContent& content);

/// Throws io::FileError when `out_folder` holds one of the inputs (a map folder or a map.csv).
void require_other_folder(const std::string& out_folder, const std::vector<std::string>& inputs);

}  // namespace orchard::cli
