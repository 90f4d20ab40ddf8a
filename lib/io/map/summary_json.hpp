// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/map_folder.hpp"

namespace orchard::io {

/// summary.json as text: how the map was made, what it contains and what was lost.
std::string summary_json(const MapFolderContent& content);

/// Warning for a georeference whose residual is above kGeoreferenceResidualMax_m.
std::string residual_warning(const geometry::Georeference& georeference);

}  // namespace orchard::io
