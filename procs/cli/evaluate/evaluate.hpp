// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/map_alignment.hpp"
#include "evaluation/trajectory_evaluation.hpp"

namespace orchard::cli {

/// `orchard evaluate MAP --truth CSV`.
struct EvaluateOptions {
  std::string map_path;  ///< a map.csv, or the folder that holds one
  std::string truth_path;
  std::string poses_path;  ///< true poses, to evaluate trajectory.csv; empty: do not
  double gate_m = 0.3;     ///< max distance of a landmark from its true object
  bool align = false;      ///< register the map to the truth first, by its trees
  evaluation::AlignmentSearch search;
  bool json = false;
  bool check = false;  ///< exit 1 unless the map is perfect
};

/// Prints the paper's tables with the error against truth; returns the exit code. Throws
/// io::FileError for missing or invalid files.
[[gnu::weak]] int run_evaluate(const EvaluateOptions& options);

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
[[gnu::weak]] int run_evaluate_trajectory(const EvaluateTrajectoryOptions& options);

}  // namespace orchard::cli
