// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// An empty place of a row.
struct InventoryGap {
  std::int32_t position = 0;
  Eigen::Vector2d p_map{0, 0};  ///< between its neighbours
};

/// What stands in a row, or in no row.
struct RowInventory {
  std::int32_t row = 0;  ///< 0: in no row
  int num_trees = 0;
  std::vector<InventoryGap> gaps;  ///< from the first to the last numbered tree
  int num_measured = 0;            ///< trees with a diameter
  double diameter_mean_m = 0.0;
  double tcsa_cm2 = 0.0;     ///< trunk cross-sectional area of all measured trees together
  double tcsa_sd_cm2 = 0.0;  ///< from width_sd_m; a lasting error of all of them is not in it
  std::int32_t first_position = 0, last_position = 0;  ///< 0: no tree has a number
};

/// How surely the trees of a map are trees: how many are above 95 %, between, and below 80 %.
struct Certainty {
  int num_sure = 0, num_likely = 0, num_unsure = 0;
};

/// A map as its grower counts it. Everything is computed from the columns of map.csv.
struct Inventory {
  std::vector<RowInventory> rows;  ///< in rising number; what is in no row last, where there is any
  RowInventory all;                ///< of all together
  int num_objects = 0;
  int num_unseen = 0;  ///< never in the camera's view
  Certainty certainty;
  double position_se_median_m = 0.0;  ///< of trees: the larger of both directions
  double width_sd_median_m = 0.0;     ///< of trees that have one
};

Inventory take_inventory(const std::vector<Landmark>& landmarks);

/// Trunk cross-sectional area of a trunk of that diameter: the horticulturists' measure of its
/// size.
double tcsa_cm2(double diameter_m);

/// Numbers of trees by diameter, in equal classes from 0; the last one holds all wider ones.
struct DiameterHistogram {
  double class_m = 0.01;
  std::vector<int> counts;
};
DiameterHistogram diameter_histogram(const std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
