// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/recording/recording_csv.hpp"

namespace orchard::io {

/// Reads a recording folder's sensors.yaml (section laser: num_beams, bearing_min_rad,
/// bearing_step_rad, range_min_m, range_max_m, and if known beam_period_us and mount).
/// Throws FileError naming file, line and key of the first error, including unknown keys.
LaserDescription parse_sensors_yaml(const std::string& yaml, const std::string& name);

}  // namespace orchard::io
