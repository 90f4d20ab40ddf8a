// SPDX-License-Identifier: BSD-3-Clause
#include "farm/cost_fit.hpp"

#include <algorithm>

namespace orchard::farm {
namespace {

/// The least-squares line; where a coefficient would be negative, the best one without it.
CostLine line_of(const std::vector<CostSample>& samples, double CostSample::*cost) {
  const auto num = static_cast<double>(samples.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const CostSample& s : samples) {
    x += s.log_mb, y += s.*cost;
    xx += s.log_mb * s.log_mb, xy += s.log_mb * s.*cost;
  }
  const double determinant = num * xx - x * x;
  const double slope = determinant > 0.0 ? (num * xy - x * y) / determinant : 0.0;
  if (slope <= 0.0) return {y / num, 0.0};
  const double at_least = (y - slope * x) / num;
  return at_least >= 0.0 ? CostLine{at_least, slope} : CostLine{0.0, xy / xx};
}

}  // namespace

CostFit fit_costs(const std::vector<CostSample>& samples) {
  // Before the first step: three times the cost of a short map of the simulated orchard.
  if (samples.empty()) return {{0.75, 0.1}, {300.0, 2.0}};
  return {line_of(samples, &CostSample::processor_s), line_of(samples, &CostSample::memory_mb)};
}

}  // namespace orchard::farm
