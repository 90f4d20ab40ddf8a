// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evaluation/trajectory_evaluation.hpp"
#include "simulation/scene/world.hpp"

namespace orchard::io {

/// Heights in true files: of ground that is not level.
enum class Heights { kNone, kWritten };

/// Reads `class,x_m,y_m,width_m`, optionally `z_m` (class tree or object; map frame; NaN without
/// the column). The objects are named T1, T2 ... and B1, B2 ... in the file's order. Throws
/// FileError naming file, line and column.
std::vector<simulation::TruthObject> read_truth_csv(const std::string& path);

/// Writes the same format atomically. Throws FileError.
void write_truth_csv(const std::string& path, const std::vector<simulation::TruthObject>& truth,
                     Heights heights = Heights::kNone);

/// Writes true poses of base in map as `utime_us,x_m,y_m,yaw_rad`, with heights also
/// `z_m,roll_rad,pitch_rad`, atomically. Throws FileError.
void write_poses_csv(const std::string& path, const std::vector<simulation::TruePose>& poses,
                     Heights heights = Heights::kNone);

/// Reads positions over time: columns utime_us, x_m, y_m and optionally yaw_rad, in any order;
/// others are ignored. trajectory.csv and a recording's poses.csv have this form. Yaw is wrapped
/// into (-pi, pi]. Throws FileError naming file, line and column, also when time does not increase
/// and for a file without poses.
evaluation::Track read_track_csv(const std::string& path);

}  // namespace orchard::io
