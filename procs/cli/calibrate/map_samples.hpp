// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/trunks/probability_learner.hpp"
#include "detection/detection.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// A log, and the folder of its map.
struct MappedLog {
  std::string log_path;
  std::string map_folder;
  std::string ids;    ///< landmarks that are trees, all others being objects; empty: their classes
  int recording = 0;  ///< of the samples
};

/// Labels the detections of a log by the landmarks of its map, with the corrections saved beside
/// it, and prints how many unless `quiet`. Without ids, warns if nobody has corrected the map.
/// Throws io::FileError for ids that the map has not, a map without path or without trees or
/// objects, and one of another log.
std::vector<calibration::ProbabilitySample> map_samples(
    const MappedLog& mapped, const std::vector<detection::Detections>& messages,
    const io::Config& config, bool quiet);

}  // namespace orchard::cli
