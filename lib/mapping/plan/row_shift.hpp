// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/plan/orchard_plan.hpp"
#include "mapping/plan/plan_evidence.hpp"

namespace orchard::mapping {

/// How far a row stands from where the plan has it.
struct RowShift {
  double along_m = 0.0;  ///< towards the row's last tree
  double aside_m = 0.0;  ///< to the left of that
  int num_trees = 0;     ///< that tell of it
};

/// One row of the plan, laid on the map.
struct LaidRow {
  std::vector<Eigen::Vector2d> places_map;
  std::vector<Eigen::Vector2d> along;      ///< unit vectors in map
  std::vector<Eigen::Vector2d> trees_map;  ///< mapped trees nearest to this row of all rows
};

/// A row set out elsewhere as a whole: by up to a little more than a tree along it, by less than
/// half an alley aside. By the likelihood of its trees, places without tree and trees without
/// place; a row stands where it was planned unless it is likelier elsewhere by odds of fifty to one
/// (rows set out wrongly are rare). Then by the median of its trees' deviations.
RowShift shift_of_row(const LaidRow& row, double spacing_m, const PlanNoise& noise,
                      const MissedAt& missed);

}  // namespace orchard::mapping
