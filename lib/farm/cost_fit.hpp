// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::farm {

/// What one step has cost.
struct CostSample {
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak
  double way_km = 0.0;
  double num_trees = 0.0;
  double log_mb = 0.0;
};

/// A cost as a sum of parts, none below zero.
struct CostLine {
  double at_least = 0.0;
  double per_km = 0.0;
  double per_tree = 0.0;
  double per_mb = 0.0;  ///< of the log
};

/// What a map costs, fitted to what maps have cost.
struct CostFit {
  CostLine time_s;     ///< by way and trees: for people
  CostLine memory_mb;  ///< the same
  CostLine ask_s;      ///< by the log's size, known before: for who schedules
  CostLine ask_mb;
};

/// Least squares with no coefficient below zero. Without samples: what drives of the simulator have
/// cost (tests/RESULTS.md, a farm).
CostFit fit_costs(const std::vector<CostSample>& samples);

}  // namespace orchard::farm
