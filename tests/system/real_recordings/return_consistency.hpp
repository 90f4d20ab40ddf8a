// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/recording_folder.hpp"
#include "laser/laser_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::test {

/// How what a drive saw last lies upon what it saw first: zero where its path closes.
struct ReturnConsistency {
  double shift_m = 0.0;  ///< of the middle of the last returns
  double turn_rad = 0.0;
  double overlap = 0.0;       ///< fraction of the last returns on the first, as the path lays them
  double best_overlap = 0.0;  ///< the same with that shift and turn
};

/// Lays the returns of the last `window_s` of a drive upon those of its first `window_s`, without
/// any of the mapper's or the localiser's parts: smoothed over 0.15 m, every shift up to 3 m and
/// turn up to 0.6 rad. None where either window saw nothing or nothing lies upon each other.
std::optional<ReturnConsistency> return_consistency(
    const std::vector<io::SensorMessage>& recording,
    const std::vector<pose::PoseEstimate>& trajectory, const laser::LaserConfig& mount,
    double window_s);

/// The path by the wheels alone, at every odometry message.
std::vector<pose::PoseEstimate> dead_reckoned(const std::vector<io::SensorMessage>& recording);

}  // namespace orchard::test
