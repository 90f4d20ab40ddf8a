// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::farm {

/// Measured cost of one step.
struct CostSample {
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak
  double way_km = 0.0;
  double num_trees = 0.0;
  double log_mb = 0.0;
};

/// Linear cost model with non-negative coefficients.
struct CostLine {
  double at_least = 0.0;
  double per_km = 0.0;
  double per_tree = 0.0;
  double per_mb = 0.0;  ///< of log size
};

/// Cost model of a map, fitted to the costs of earlier maps.
struct CostFit {
  CostLine time_s;     ///< by distance and number of trees, for display
  CostLine memory_mb;  ///< by distance and number of trees, for display
  CostLine ask_s;      ///< by log size, which is known in advance, for the scheduler
  CostLine ask_mb;
};

/// Fits the model by non-negative least squares. Without samples it returns the cost of simulated
/// drives (tests/RESULTS.md, a farm).
CostFit fit_costs(const std::vector<CostSample>& samples);

}  // namespace orchard::farm
