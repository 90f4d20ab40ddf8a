// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/prior_map/prior_map.hpp"
#include "pose/prior_map/prior_map_config.hpp"

namespace orchard::io {

/// The landmarks of config.map_file (a map.csv, or a folder that holds one) that were seen at least
/// config.min_observations times. The file is only read. Throws FileError when it cannot be read,
/// or when no place can be found by what it holds.
std::vector<pose::PriorLandmark> read_prior_map(const pose::PriorMapConfig& config);

}  // namespace orchard::io
