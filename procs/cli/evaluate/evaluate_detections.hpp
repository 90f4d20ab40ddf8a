// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/detections/detection_evaluation.hpp"

namespace orchard::cli {

/// `orchard evaluate detections MAP_DIR|DERIVED_LOG... --observations CSV...`.
struct EvaluateDetectionsOptions {
  std::vector<std::string> paths;              ///< map folders or logs with detections
  std::vector<std::string> observation_paths;  ///< truth of each one's scans, in the same order
  std::vector<std::string> truth_paths;  ///< true objects, one file per path, for the landmarks
  bool json = false;
  evaluation::DetectionRules rules;
  bool without_picture = false;  ///< also count objects outside the picture
};

/// Evaluates detections against the truth of each scan and prints the result; returns the exit
/// code. Throws io::FileError for missing or invalid files.
int run_evaluate_detections(const EvaluateDetectionsOptions& options);

}  // namespace orchard::cli
