// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::mapping {

/// derived: Prior probability of each kind of change of a tree between two drives.
inline constexpr double kChangedFraction = 0.05;

/// Scatter of pairs of one object between two maps.
struct PairScatter {
  double position_sd_m = 0.02;  ///< per axis
  double width_sd_m = 0.01;
  double width_common_m = 0.0;  ///< median width change of all trees
  double width_mean_m = 0.1;    ///< of the trunks of the later map
  double width_spread_m = 0.02;
  double spacing_m = 2.0;    ///< median distance of neighbouring trees
  double moved_max_m = 1.0;  ///< max distance of a move; farther away it is another tree
  double width_outliers_of_trees = 0.003;  ///< of unchanged trees, estimated from shrunk ones
  double width_outliers_of_others = 0.05;  ///< the same for pairs that are not trees in both maps
};

/// Comparison of one landmark of the earlier map with one of the later map.
struct PairObservation {
  double distance_m = 0.0;
  double width_b_m = 0.0;
  double width_change_m = 0.0;
  double noise_factor = 1.0;  ///< on position and width sd; larger for few observations
  double width_sd_m = 0.0;    ///< sd of the width change; 0: use noise_factor
  double not_repeated = 0.0;  ///< probability that both exist and each drive missed the other one
  bool both_trees = true;
};

/// Posterior probabilities of the change of an object; they sum to 1.
struct ChangePosterior {
  double unchanged = 0.0;
  double changed_with_all = 0.0;  ///< same position, width changed like that of all trees
  double moved = 0.0;
  double width_changed = 0.0;
  double replaced = 0.0;      ///< the earlier one is gone, the later one is new
  double not_repeated = 0.0;  ///< two objects, each observed by one drive only
};

/// Computes the posterior by Bayes' rule. Prior of each change: 1/20. Likelihoods: unchanged
/// objects scatter as `scatter` with a few outliers; a moved one is uniform within moved_max_m with
/// its width unchanged; a new one is uniform with the width distribution of all trunks.
ChangePosterior change_posterior(const PairObservation& pair, const PairScatter& scatter);

/// Estimates the fraction of width outliers of unchanged pairs. Trunks do not become thinner, so
/// the number of positive outliers equals that of pairs thinner by four standard errors.
/// `deviations`: width changes minus the common one, in standard errors. Shrunk towards `expected`
/// with the weight of `weight` pairs.
double outlier_fraction(const std::vector<double>& deviations, double expected, double weight);

/// Probability that an unobserved object is gone. `probability_missed`: of missing an existing
/// object; `real`: probability that it existed at all.
double confidence_of_absence(double probability_missed, double real);

}  // namespace orchard::mapping
