// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::evaluation {

/// A stated probability and its outcome.
struct Forecast {
  double probability = 0.0;
  bool came_true = false;
};

/// A bin of forecasts with similar probability.
struct ReliabilityBin {
  double from = 0.0;  ///< lower bound, inclusive
  double to = 0.0;    ///< upper bound, exclusive except for 1
  int num = 0;
  double mean_probability = 0.0;  ///< 0 when empty
  double frequency = 0.0;         ///< observed frequency; 0 when empty
};

/// Calibration of probabilities: reliability diagram, expected calibration error and Brier score.
struct Reliability {
  std::vector<ReliabilityBin> bins;  ///< equal widths over [0, 1]
  int num = 0;
  /// Expected calibration error: |frequency - mean probability| of each bin, averaged over all
  /// forecasts. Source: Naeini et al. 2015, equal-width bins. 0 when there are none.
  double expected_calibration_error = 0.0;
  double brier_score = 0.0;  ///< mean square of probability - outcome
};

/// Computes the reliability of forecasts. Throws std::invalid_argument for fewer than one bin or a
/// probability outside [0, 1].
Reliability reliability(const std::vector<Forecast>& forecasts, int num_bins = 10);

}  // namespace orchard::evaluation
