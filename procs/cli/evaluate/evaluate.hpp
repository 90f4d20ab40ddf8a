// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/map_alignment.hpp"

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
int run_evaluate(const EvaluateOptions& options);

}  // namespace orchard::cli
