// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// A landmark's names in the plan.
struct PlanName {
  std::int32_t landmark_id = 0;
  std::string row;
  std::string tree;  ///< empty: an extra tree of that row
};

struct PlanNumbers {
  std::vector<Row> rows;        ///< in rising number; places without tree are gaps
  std::vector<PlanName> names;  ///< in order of the landmarks
};

/// Numbers a map by its plan, into its landmarks and rows. Names that are whole numbers, all
/// different, are the numbers; else rows, or the trees of one row, are counted as the plan has
/// them. Extra trees have their row's number and no position, or neither; objects neither.
PlanNumbers number_by_plan(const OrchardPlan& plan, const PlanMatch& match,
                           std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
