// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/detections/reliability.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orchard::evaluation {

Reliability reliability(const std::vector<Forecast>& forecasts, int num_bins) {
  if (num_bins < 1) throw std::invalid_argument("reliability: at least one bin is needed");
  Reliability result;
  result.bins.resize(static_cast<std::size_t>(num_bins));
  for (int i = 0; i < num_bins; ++i) {
    result.bins[static_cast<std::size_t>(i)].from = static_cast<double>(i) / num_bins;
    result.bins[static_cast<std::size_t>(i)].to = static_cast<double>(i + 1) / num_bins;
  }
  for (const Forecast& forecast : forecasts) {
    const double p = forecast.probability;
    if (!(p >= 0.0 && p <= 1.0)) {
      throw std::invalid_argument("reliability: a probability must be in [0, 1]");
    }
    const int i = std::min(num_bins - 1, static_cast<int>(p * num_bins));
    ReliabilityBin& bin = result.bins[static_cast<std::size_t>(i)];
    const double outcome = forecast.came_true ? 1.0 : 0.0;
    ++bin.num;
    bin.mean_probability += p;
    bin.frequency += outcome;
    result.brier_score += (p - outcome) * (p - outcome);
  }
  result.num = static_cast<int>(forecasts.size());
  if (result.num == 0) return result;
  for (ReliabilityBin& bin : result.bins) {
    if (bin.num == 0) continue;
    bin.mean_probability /= bin.num;
    bin.frequency /= bin.num;
    result.expected_calibration_error +=
        bin.num * std::abs(bin.mean_probability - bin.frequency) / result.num;
  }
  result.brier_score /= result.num;
  return result;
}

}  // namespace orchard::evaluation
