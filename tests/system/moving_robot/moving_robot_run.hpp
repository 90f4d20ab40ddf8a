// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration/extrinsics/camera_delay.hpp"
#include "evaluation/map_evaluation.hpp"
#include "system/moving_robot/weaving_drive.hpp"

namespace orchard::test {

/// What came of a run.
struct Outcome {
  evaluation::MapEvaluation map;
  int num_tree_observations = 0;  ///< detections of true trees that the camera judged
  int num_judged_tree = 0;        ///< of them TREE
  double judged_tree() const {
    return num_tree_observations > 0 ? static_cast<double>(num_judged_tree) / num_tree_observations
                                     : 0.0;
  }
};

/// Detector, pose and mapper over a run.
Outcome map_run(const RobotRun& run, const io::Config& config);

/// `orchard calibrate delay` on runs: the delay, from that of `config`. Throws as estimate_delay().
calibration::DelayEstimate measure_delay(const std::vector<RobotRun>& runs, io::Config config);

}  // namespace orchard::test
