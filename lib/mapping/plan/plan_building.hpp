// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/plan/orchard_plan.hpp"

namespace orchard::mapping {

/// A planned tree as a file has it; names may be empty.
struct LoosePlannedTree {
  std::string row;
  std::string tree;
  Eigen::Vector2d p_plan{0, 0};
};

/// A planned row as a file has it: a line [m], along which trees stand.
struct PlannedLine {
  std::string row;
  std::vector<Eigen::Vector2d> points;
};

/// A plan, and what had to be decided to make one of it.
struct BuiltPlan {
  OrchardPlan plan;
  std::vector<std::string> notes;     ///< a sentence each, without a full stop
  std::vector<std::string> problems;  ///< not empty: the plan cannot be used
};

/// Rows of single trees. Rows keep the order in which they first come; without row names they are
/// found as the mapper finds them in its maps. Trees are put in the order of their numbers, else
/// along the row from the end where the file begins; without names they are numbered so. Problems:
/// a name given twice, two trees in one place.
BuiltPlan plan_of_trees(const std::vector<LoosePlannedTree>& trees);

/// Rows given as lines: a tree at each line's begin and then every `spacing_m` along it. Lines
/// without a name are numbered.
BuiltPlan plan_of_lines(const std::vector<PlannedLine>& lines, double spacing_m);

/// Positive whole number that a name is, at most nine digits; 0 for another name.
std::int32_t number_in_name(const std::string& name);

}  // namespace orchard::mapping
