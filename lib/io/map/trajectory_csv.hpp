// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// trajectory.csv as text: `utime_us,x_m,y_m,yaw_rad` (T_map_base over time), with fixed number
/// formats.
std::string trajectory_csv(const std::vector<pose::PoseEstimate>& trajectory);

/// The same in pieces, for long drives; `trajectory` must outlive the returned function.
TextPieces trajectory_csv_pieces(const std::vector<pose::PoseEstimate>& trajectory);

/// The same in the format of the TUM RGB-D benchmark, for evo and other tools: a line `seconds x y
/// z qx qy qz qw` per pose.
TextPieces trajectory_tum_pieces(const std::vector<pose::PoseEstimate>& trajectory);

void write_trajectory_csv(const std::string& path,
                          const std::vector<pose::PoseEstimate>& trajectory);

/// Reads a trajectory.csv; seq counts from 0, yaw is wrapped into (-pi, pi]. Throws FileError
/// naming file, line and column, also when time does not increase.
std::vector<pose::PoseEstimate> read_trajectory_csv(const std::string& path);
std::vector<pose::PoseEstimate> parse_trajectory_csv(std::string_view text,
                                                     const std::string& name);

}  // namespace orchard::io
