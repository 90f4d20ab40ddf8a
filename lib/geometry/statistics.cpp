// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace orchard::geometry {

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(fraction * static_cast<double>(values.size()));
  const auto found =
      values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), found, values.end());
  return *found;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double midpoint_median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

double robust_sd(std::vector<double> deviations) {
  for (double& d : deviations) d = std::abs(d);
  return kMadToSd * median(std::move(deviations));
}

double roc_area(const std::vector<double>& positives, const std::vector<double>& negatives) {
  if (positives.empty() || negatives.empty()) return 0.5;
  std::vector<double> sorted = negatives;
  std::sort(sorted.begin(), sorted.end());
  double wins = 0.0;
  for (const double score : positives) {
    const auto [low, high] = std::equal_range(sorted.begin(), sorted.end(), score);
    wins += 0.5 * (static_cast<double>(low - sorted.begin()) +
                   static_cast<double>(high - sorted.begin()));
  }
  return wins / (static_cast<double>(positives.size()) * static_cast<double>(sorted.size()));
}

}  // namespace orchard::geometry
