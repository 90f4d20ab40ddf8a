// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"

namespace orchard::cli {

/// Converts a stored map to the content of a new folder: landmarks, paths, coverage, georeference;
/// without rows. Maps store no beams: the area beside a driven path counts as seen free.
io::MapFolderContent content_of(const io::StoredMap& map);

/// The same content's summary: this program's version, and the times of the paths.
io::MapSummary summary_of(const io::StoredMap& map);

/// The same content's free space: the area beside the paths; none without paths.
mapping::FreeSpaceTest seen_free_of(const io::StoredMap& map);

}  // namespace orchard::cli
