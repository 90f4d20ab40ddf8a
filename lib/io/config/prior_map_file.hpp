// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/prior_map/prior_map.hpp"
#include "pose/prior_map/prior_map_config.hpp"

namespace orchard::io {

/// The landmarks of config.map_file (a map.csv, or a folder that holds one) that were seen at least
/// config.min_observations times; of a folder also where its drives looked, and so how often each
/// landmark was seen of its chances. The files are only read. Throws FileError when one cannot be
/// read, or when no place can be found by what they hold.
pose::EarlierMap read_prior_map(const pose::PriorMapConfig& config);

}  // namespace orchard::io
