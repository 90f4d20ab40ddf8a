// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// map.csv as text: the columns listed in README.md, with fixed number formats.
std::string map_csv(const std::vector<mapping::Landmark>& landmarks);

/// Whether a path is to be read as a map of this program: a folder, a file whose header begins like
/// that of a map.csv, a compressed one, and what cannot be opened; any other file is a survey.
bool is_map(const std::string& path);

/// Reads a map.csv (plain or .gz). The covariance, which the file lacks, is set to 0. Throws
/// FileError naming file, line and column of the first error, including a repeated id.
std::vector<mapping::Landmark> read_map_csv(const std::string& path);

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

}  // namespace orchard::io
