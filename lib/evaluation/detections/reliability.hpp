// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::evaluation {

/// A stated probability and what turned out.
struct Forecast {
  double probability = 0.0;
  bool came_true = false;
};

/// Forecasts of about the same probability.
struct ReliabilityBin {
  double from = 0.0;  ///< of the bin, inclusive
  double to = 0.0;    ///< exclusive, but for 1
  int num = 0;
  double mean_probability = 0.0;  ///< 0 when empty
  double frequency = 0.0;         ///< fraction that came true; 0 when empty
};

/// Whether probabilities mean what they say: the reliability diagram and its one number.
struct Reliability {
  std::vector<ReliabilityBin> bins;  ///< of equal width over [0, 1]
  int num = 0;
  /// Expected calibration error: mean over all forecasts of their bin's |frequency - mean
  /// probability|. Source: Naeini et al. 2015, equal-width bins. 0 when there are none.
  double expected_calibration_error = 0.0;
  double brier_score = 0.0;  ///< mean square of probability - outcome
};

/// Throws std::invalid_argument for fewer than one bin or a probability outside [0, 1].
Reliability reliability(const std::vector<Forecast>& forecasts, int num_bins = 10);

}  // namespace orchard::evaluation
