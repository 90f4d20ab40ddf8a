// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "mapping/compare/map_comparison.hpp"
#include "mapping/kind.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Growth of the trunks measured in both maps.
struct Growth {
  int num_pairs = 0;
  double tcsa_before_cm2 = 0.0;  ///< sum over these trees
  double tcsa_change_cm2 = 0.0;
  double percent() const {
    return tcsa_before_cm2 > 0.0 ? 100.0 * tcsa_change_cm2 / tcsa_before_cm2 : 0.0;
  }
};

/// derived: no row has this number. Growth by row of the later map, 0 for no row; here the total of
/// the trunks that count there.
inline constexpr std::int32_t kGrowthOfAll = -1;
using GrowthByRow = std::map<std::int32_t, Growth>;

/// Computes the growth of the trees found in both maps (unchanged, moved, grown, thinner) with a
/// width in both. `comparison`: of `earlier` (a) and `later` (b).
GrowthByRow growth_by_row(const std::vector<Landmark>& earlier, const std::vector<Landmark>& later,
                          const MapComparison& comparison);

/// An empty slot of a row.
struct InventoryGap {
  std::int32_t position = 0;
  Eigen::Vector2d p_map{0, 0};  ///< interpolated between its neighbours
};

/// How steep a row is, from its first tree to its last.
struct RowSlope {
  double percent = 0.0;     ///< rise per 100 m
  double percent_sd = 0.0;  ///< neighbours share their errors
  double rise_m = 0.0;      ///< from the first tree to the last, by the slope
};

/// The line that fits the heights of a row's trees best; none with fewer than three heights.
/// `trees`: in order of position.
std::optional<RowSlope> row_slope(const std::vector<Landmark>& trees);

/// Trunks of one row, or of several together.
struct RowInventory {
  std::int32_t row = 0;  ///< 0: of several
  int num_trees = 0;
  std::vector<InventoryGap> gaps;  ///< between the first and last numbered tree
  int num_measured = 0;            ///< trees with a diameter
  double diameter_mean_m = 0.0;
  double tcsa_cm2 = 0.0;     ///< total trunk cross-sectional area of the measured trees
  double tcsa_sd_cm2 = 0.0;  ///< from width_sd_m; without the error common to all
  std::int32_t first_position = 0, last_position = 0;  ///< 0: no numbered tree
  std::optional<RowSlope> slope;                       ///< of one row with heights
};

/// Number of trees with a probability of at least 95 %, between, and below 80 %.
struct CertaintyCounts {
  int num_sure = 0, num_likely = 0, num_unsure = 0;
};

/// Tree counts and trunk areas of a map, computed from the columns of map.csv. Certainty and errors
/// are those of the trunks that count (KindCounts::counts()).
struct Inventory {
  KindCounts kinds;
  std::vector<RowInventory> rows;  ///< in order of number
  RowInventory all;                ///< total of the trunks that count
  RowInventory other;              ///< trunks that do not count: in no row, though there are rows
  CertaintyCounts certainty;
  double position_se_median_m = 0.0;  ///< the larger of x and y
  double width_sd_median_m = 0.0;     ///< of trunks with a width_sd_m
};

/// Whether the slope of any row is known.
bool has_slopes(const Inventory& inventory);

Inventory compute_inventory(const std::vector<Landmark>& landmarks);

/// Trunk cross-sectional area of a trunk: the horticultural measure of its size.
double tcsa_cm2(double diameter_m);

/// Number of the trunks that count by diameter, in equal classes from 0; the last class includes
/// all wider ones.
struct DiameterHistogram {
  double class_m = 0.01;
  std::vector<int> counts;
};
DiameterHistogram diameter_histogram(const std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
