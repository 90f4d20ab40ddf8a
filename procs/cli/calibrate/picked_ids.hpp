// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::cli {

/// Parses the --ids of landmarks of a map, such as "4,8,10-12", in ascending order; `map_path` is
/// named in messages. Throws io::FileError for anything else, and naming all ids that the map has
/// not.
std::vector<int> picked_ids(const std::string& text,
                            const std::vector<mapping::Landmark>& landmarks,
                            const std::string& map_path);

}  // namespace orchard::cli
