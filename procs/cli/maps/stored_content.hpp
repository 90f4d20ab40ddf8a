// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"

namespace orchard::cli {

/// A map that was read back as the content of a new folder: landmarks, paths, view, place on the
/// earth; without rows. Maps keep no beams: what lies beside a driven path counts as seen free.
io::MapFolderContent content_of(const io::StoredMap& map);

}  // namespace orchard::cli
