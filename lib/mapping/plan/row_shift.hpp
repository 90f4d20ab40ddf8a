// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/plan/orchard_plan.hpp"
#include "mapping/plan/plan_evidence.hpp"

namespace orchard::mapping {

/// Offset of a row from its planned position.
struct RowShift {
  double along_m = 0.0;  ///< towards the last tree of the row
  double aside_m = 0.0;  ///< to the left
  int num_trees = 0;     ///< number of trees used
};

/// One row of the plan, transformed to map.
struct RegisteredRow {
  std::vector<Eigen::Vector2d> places_map;
  std::vector<Eigen::Vector2d> along;      ///< unit vectors in map
  std::vector<Eigen::Vector2d> trees_map;  ///< mapped trees that are nearest to this row
};

/// Finds the shift of a row that was planted elsewhere as a whole: up to 1.2 spacings along and
/// less than half an alley to the side. Maximises the likelihood of trees and empty positions, with
/// a prior of one shifted row in fifty. The shift is the median offset of the trees.
RowShift shift_of_row(const RegisteredRow& row, double spacing_m, const PlanNoise& noise,
                      const MissProbability& missed);

}  // namespace orchard::mapping
