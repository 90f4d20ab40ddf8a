// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::mapping {

/// Share of the trees to which one kind of change happens between two drives, before looking.
inline constexpr double kShareChanged = 0.05;

/// How what stands in both of two maps differs between them.
struct PairScatter {
  double position_sd_m = 0.02;  ///< per axis
  double width_sd_m = 0.01;
  double width_common_m = 0.0;  ///< by which all are wider in the later map
  double width_mean_m = 0.1;    ///< of the trunks of the later map
  double width_spread_m = 0.02;
  double spacing_m = 2.0;                ///< of trees
  double moved_max_m = 1.0;              ///< what is farther away is another tree
  double stray_widths_of_trees = 0.003;  ///< share of unchanged trees whose width is off by more
                                         ///< than its noise: as the pairs show that became thinner
  double stray_widths_of_others = 0.05;  ///< the same of pairs that are not trees in both maps
};

/// One thing of the earlier map beside one of the later map.
struct PairSight {
  double distance_m = 0.0;
  double width_b_m = 0.0;
  double width_change_m = 0.0;
  double noise_factor =
      1.0;  ///< of position and width, over that of what is seen as often as usual
  bool both_trees = true;
};

/// What may have become of the earlier thing, if it has become the later one or given way to it;
/// the five add up to 1.
struct PairOdds {
  double unchanged = 0.0;
  double changed_with_all = 0.0;  ///< stands as before, and its width changed as that of all trees
  double moved = 0.0;
  double width_changed = 0.0;
  double replaced = 0.0;  ///< it has gone, and the later one has come
};

/// Weighs them by Bayes' rule: each change befalls one tree in twenty; things that stay scatter
/// as `scatter` says, a few of them more; what is moved stands anywhere within moved_max_m and is
/// as wide as before; what is new stands anywhere and is as wide as any trunk.
PairOdds odds_of(const PairSight& pair, const PairScatter& scatter);

/// Share of stray widths among unchanged pairs: trunks do not become thinner, so as many have
/// strayed upwards as are thinner by four standard errors. `deviations`: of width changes from the
/// common one, in standard errors. A few pairs say little against `expected` (that of `weight`).
double stray_share(const std::vector<double>& deviations, double expected, double weight);

/// That a thing is gone that was not found where it would have been missed with that chance, when
/// it stood there with probability `real`.
double confidence_of_absence(double probability_missed, double real);

}  // namespace orchard::mapping
