// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::calibration {

/// Area under the ROC curve: how often a positive scores higher than a negative, ties counting
/// half. 0.5 is chance; 0.5 too when either list is empty. Scores must be finite.
double roc_area(const std::vector<double>& positives, const std::vector<double>& negatives);

}  // namespace orchard::calibration
