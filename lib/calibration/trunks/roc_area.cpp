// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/roc_area.hpp"

#include <algorithm>

namespace orchard::calibration {

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

}  // namespace orchard::calibration
