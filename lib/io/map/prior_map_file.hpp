// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/pose_config.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::io {

/// Reads the prior map: the landmarks of prior_map.map_file (a map.csv or a map folder) with at
/// least min_observations observations. From a folder also the sensor coverage of its drives, and
/// from that the detection rate of each landmark.
///
/// Any other file is a survey (read_survey(), by the program orchard-gis): each point is a
/// landmark of unknown kind and width that any visit sees, with its stated accuracy or
/// survey_sd_m. Degrees become metres east and north of gnss.datum, or of the middle of the survey
/// without one. The files are only read. Throws FileError when one cannot be read, or when its
/// landmarks are not sufficient for localization.
pose::PriorMapData read_prior_map(const pose::PoseConfig& config);

}  // namespace orchard::io
