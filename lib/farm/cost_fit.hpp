// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::farm {

/// Measured cost of one map.
struct CostSample {
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak
  double log_mb = 0.0;
};

/// Linear cost model with non-negative coefficients.
struct CostLine {
  double at_least = 0.0;
  double per_mb = 0.0;  ///< of log size, which is known in advance

  double of(double log_mb) const { return at_least + per_mb * log_mb; }
};

/// Cost model of a map, fitted to the costs of earlier maps.
struct CostFit {
  CostLine time_s;
  CostLine memory_mb;
};

/// Fits the model by non-negative least squares. Without samples it returns the cost of simulated
/// drives (tests/RESULTS.md, a farm).
CostFit fit_costs(const std::vector<CostSample>& samples);

}  // namespace orchard::farm
