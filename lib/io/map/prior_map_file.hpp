// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/pose_config.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::io {

/// Reads the prior map: the landmarks of config.map_file (a map.csv or a map folder) with at least
/// config.min_observations observations. From a folder also the sensor coverage of its drives, and
/// from that the detection rate of each landmark. The files are only read. Throws FileError when
/// one cannot be read, or when its landmarks are not sufficient for localization.
pose::PriorMapData read_prior_map(const pose::PriorMapConfig& config);

}  // namespace orchard::io
