// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "worlds/observation_truth.hpp"

namespace orchard::io {

/// Reads `utime_us,object,class,x_m,y_m,width_m,range_m,bearing_rad,num_beams,hidden_fraction,
/// in_picture`: one row per scan and object that the scanner could see (TrueObservation). Throws
/// FileError naming file, line and column; also when scans are not in order of time, or an object
/// occurs twice in one scan or changes its class.
std::vector<simulation::TrueObservation> read_observation_csv(const std::string& path);

/// Writes the same format atomically. Throws FileError.
void write_observation_csv(const std::string& path,
                           const std::vector<simulation::TrueObservation>& observations);

}  // namespace orchard::io
