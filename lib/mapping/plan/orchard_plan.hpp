// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace orchard::mapping {

/// A place where a tree was meant to be planted.
struct PlannedTree {
  std::string name;  ///< within its row: "14"
  Eigen::Vector2d p_plan{0, 0};
};

/// A row of the plan, its trees in order along it.
struct PlannedRow {
  std::string name;  ///< "3", "B12"
  std::vector<PlannedTree> trees;
};

/// The grower's plan of a block; no row is empty, no name stands there twice.
struct OrchardPlan {
  std::vector<PlannedRow> rows;

  std::size_t num_trees() const;
  /// Of all trees in order of rows [m].
  std::vector<Eigen::Vector2d> places() const;
};

/// Which tree of a plan: indices into rows and their trees, in order of places().
struct PlanIndex {
  std::int32_t row = 0;
  std::int32_t tree = 0;
};
std::vector<PlanIndex> plan_indices(const OrchardPlan& plan);

/// Unit vectors along the row at each tree, from its neighbours in the row; in order of places().
/// A row of one tree has the direction of the whole plan's first longer row, else of x.
std::vector<Eigen::Vector2d> directions_along_rows(const OrchardPlan& plan);

/// What people check of a row before they trust a plan.
struct PlannedRowFacts {
  double length_m = 0.0;
  double spacing_m = 0.0;  ///< median between neighbours; 0 for a single tree
  double spacing_least_m = 0.0;
  double spacing_most_m = 0.0;
};
PlannedRowFacts facts_of(const PlannedRow& row);

/// Median distance from a tree to the nearest one of another row [m]; 0 for a single row.
double typical_alley_m(const OrchardPlan& plan);

}  // namespace orchard::mapping
