// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/trajectory/trajectory_evaluation.hpp"

namespace orchard::cli {

/// `orchard evaluate trajectory TRAJECTORY --truth CSV`.
struct EvaluateTrajectoryOptions {
  std::string trajectory_path;  ///< a trajectory.csv, or the folder that holds one
  std::string truth_path;
  bool align = false;
  bool align_origin = false;
  bool nearest = false;
  double gap_max_s = 0.0;  ///< 0 = three median intervals of the truth
  evaluation::TrajectoryRules rules;
  bool json = false;
};

/// Prints absolute and relative errors as evo computes them; returns the exit code: 1 when no poses
/// could be compared. Throws io::FileError for missing or invalid files.
int run_evaluate_trajectory(const EvaluateTrajectoryOptions& options);

}  // namespace orchard::cli
