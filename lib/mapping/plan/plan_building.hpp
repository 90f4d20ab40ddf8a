// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/plan/orchard_plan.hpp"

namespace orchard::mapping {

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

/// Builds rows from single trees. Rows are in order of first appearance; without row names they are
/// found by find_rows(). Trees are sorted by number, else along the row starting at the end where
/// the file starts; without names they are numbered in this order. Problems: duplicate names, two
/// trees at one position.
BuiltPlan plan_of_trees(const std::vector<LoosePlannedTree>& trees);

/// Builds rows from lines: a tree at the start of each line and then every `spacing_m` along it.
/// Lines without names are numbered.
BuiltPlan plan_of_lines(const std::vector<PlannedLine>& lines, double spacing_m);

/// The number in a name of up to nine digits; 0 for any other name.
std::int32_t number_in_name(const std::string& name);

}  // namespace orchard::mapping
