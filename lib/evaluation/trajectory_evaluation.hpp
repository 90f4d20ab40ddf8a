// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/pose_estimate.hpp"
#include "simulation/world.hpp"

namespace orchard::evaluation {

/// A trajectory against the truth, at the truth's times.
struct TrajectoryEvaluation {
  int num_compared = 0;
  int num_outside = 0;  ///< true poses before the first or after the last estimate
  double position_rms_m = 0.0;
  double position_max_m = 0.0;
  double yaw_rms_rad = 0.0;
  double yaw_max_rad = 0.0;
};

/// Compares T_map_base over time. The estimates, in order of utime, are interpolated linearly
/// (yaw along the shorter way) to the times of the true poses; nothing is extrapolated. Throws
/// std::invalid_argument when estimates are out of order.
TrajectoryEvaluation evaluate_trajectory(const std::vector<pose::PoseEstimate>& estimates,
                                         const std::vector<simulation::TruePose>& truth);

}  // namespace orchard::evaluation
