// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// Reads all detections messages of a log, or of derived.lcm in a map folder, in order. Throws
/// io::FileError for a file that cannot be read or has none.
std::vector<detection::Detections> read_detections(const std::string& path);

/// The same; for a log with scans it runs this rig's detector instead.
std::vector<detection::Detections> detect_log(const std::string& path, const io::Config& config,
                                              bool show_progress);

}  // namespace orchard::cli
