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
double typical_aisle_m(const OrchardPlan& plan);

/// A planned tree as read from a file; names may be empty.
struct LoosePlannedTree {
  std::string row;
  std::string tree;
  Eigen::Vector2d p_plan{0, 0};
};

/// A planned row as read from a file: a polyline [m] along which trees stand.
struct PlannedLine {
  std::string row;
  std::vector<Eigen::Vector2d> points;
};

/// A plan with the decisions and problems of building it.
struct BuiltPlan {
  OrchardPlan plan;
  std::vector<std::string> notes;     ///< one sentence each, without full stop
  std::vector<std::string> problems;  ///< if not empty, the plan cannot be used
};

/// Builds rows from single trees. Rows are in order of name, in which A2 comes before A10; without
/// row names they are found by find_rows(). Trees are sorted by number, else along the row starting
/// at the end where the file starts; without names they are numbered in this order. Problems:
/// duplicate names, two trees at one position.
BuiltPlan plan_of_trees(const std::vector<LoosePlannedTree>& trees);

/// Builds rows from lines: a tree at the start of each line and then every `spacing_m` along it.
/// Lines without names are numbered.
BuiltPlan plan_of_lines(const std::vector<PlannedLine>& lines, double spacing_m);

/// The number in a name of up to nine digits; 0 for any other name.
std::int32_t number_in_name(const std::string& name);

}  // namespace orchard::mapping
