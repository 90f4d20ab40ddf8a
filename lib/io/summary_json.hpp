// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map_folder.hpp"

namespace orchard::io {

/// summary.json as text: how the map was made, what it holds, what was lost on the way.
std::string summary_json(const MapFolderContent& content);

}  // namespace orchard::io
