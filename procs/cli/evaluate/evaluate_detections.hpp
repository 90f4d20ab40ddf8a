// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/detections/detection_evaluation.hpp"

namespace orchard::cli {

/// `orchard evaluate detections MAP_DIR|DERIVED_LOG... --observations CSV...`.
struct EvaluateDetectionsOptions {
  std::vector<std::string> paths;              ///< map folders or logs with detections
  std::vector<std::string> observation_paths;  ///< what each truly held, in the same order
  std::vector<std::string> truth_paths;  ///< what stands there; none, or as many: landmarks too
  std::string html_path;                 ///< empty = no page
  bool json = false;
  evaluation::DetectionRules rules;
  bool without_picture = false;  ///< count what the camera does not have, too
};

/// Prints how good detections are against the truth of each scan; returns the exit code. Throws
/// io::FileError for files that are not what they should be.
int run_evaluate_detections(const EvaluateDetectionsOptions& options);

}  // namespace orchard::cli
