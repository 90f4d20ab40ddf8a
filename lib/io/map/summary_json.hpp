// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/map_folder.hpp"

namespace orchard::io {

/// summary.json as text: how the map was made, what it holds, what was lost on the way.
std::string summary_json(const MapFolderContent& content);

/// What is said of a georeference whose residual is above kGeoreferenceResidualMax_m.
std::string residual_warning(const geometry::Georeference& georeference);

}  // namespace orchard::io
