// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/plan/plan_match.hpp"

namespace orchard::mapping {

/// The names of a landmark in the plan.
struct PlanName {
  std::int32_t landmark_id = 0;
  std::string row;
  std::string tree;  ///< empty for an extra tree of the row
};

/// Numbers the landmarks and rows of a map by its plan. Names are used as numbers if they are all
/// different whole numbers; else rows, or the trees of a row, are counted in the order of the plan.
/// Extra trees get their row's number, if they are in a row, and no position; objects get neither.
/// Returns the names, in order of the landmarks.
std::vector<PlanName> number_by_plan(const OrchardPlan& plan, const PlanMatch& match,
                                     std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
