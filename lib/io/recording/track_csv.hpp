// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::io {

/// Reads positions over time: columns utime_us, x_m, y_m and optionally yaw_rad, in any order;
/// others are ignored. trajectory.csv and a recording's poses.csv have this form. Yaw is wrapped
/// into (-pi, pi]. Throws FileError naming file, line and column, also when time does not increase
/// and for a file without poses.
evaluation::Track read_track_csv(const std::string& path);

}  // namespace orchard::io
