// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace orchard::mapping {

/// A planned tree position.
struct PlannedTree {
  std::string name;  ///< within its row, e.g. "14"
  Eigen::Vector2d p_plan{0, 0};
};

/// A planned row; its trees in order along it.
struct PlannedRow {
  std::string name;  ///< e.g. "3", "B12"
  std::vector<PlannedTree> trees;
};

/// The grower's plan of a block. Rows are not empty and names are unique.
struct OrchardPlan {
  std::vector<PlannedRow> rows;

  std::size_t num_trees() const;
  /// Positions of all trees in order of rows [m].
  std::vector<Eigen::Vector2d> places() const;
};

/// Identifies a planned tree: indices of row and tree, in order of places().
struct PlanIndex {
  std::int32_t row = 0;
  std::int32_t tree = 0;
};
std::vector<PlanIndex> plan_indices(const OrchardPlan& plan);

/// Unit vectors along the row at each tree, from its neighbours in the row; in order of places(). A
/// row of one tree gets the direction of the plan's first longer row, else that of x.
std::vector<Eigen::Vector2d> directions_along_rows(const OrchardPlan& plan);

/// Summary of a row, for people who check a plan.
struct PlannedRowFacts {
  double length_m = 0.0;
  double spacing_m = 0.0;  ///< median distance of neighbours; 0 for a single tree
  double spacing_min_m = 0.0;
  double spacing_max_m = 0.0;
};
PlannedRowFacts row_facts(const PlannedRow& row);

/// Median distance from a tree to the nearest one of another row [m]; 0 for a single row.
double typical_alley_m(const OrchardPlan& plan);

}  // namespace orchard::mapping
