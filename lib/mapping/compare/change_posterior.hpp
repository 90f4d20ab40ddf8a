// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::mapping {

/// Prior fraction of trees to which one kind of change happens between two drives.
inline constexpr double kChangedFraction = 0.05;

/// Scatter of pairs of one object between two maps.
struct PairScatter {
  double position_sd_m = 0.02;  ///< per axis
  double width_sd_m = 0.01;
  double width_common_m = 0.0;  ///< change of width that all trees have in common
  double width_mean_m = 0.1;    ///< of the trunks of the later map
  double width_spread_m = 0.02;
  double spacing_m = 2.0;                  ///< of trees
  double moved_max_m = 1.0;                ///< farther away it is another tree
  double width_outliers_of_trees = 0.003;  ///< fraction of unchanged trees, by those that shrank
  double width_outliers_of_others = 0.05;  ///< the same of pairs that are not trees in both maps
};

/// One landmark of the earlier map compared with one of the later map.
struct PairObservation {
  double distance_m = 0.0;
  double width_b_m = 0.0;
  double width_change_m = 0.0;
  double noise_factor = 1.0;  ///< of position and width: larger for few observations
  double width_sd_m = 0.0;    ///< of the change of width; 0: by noise_factor
  double not_repeated = 0.0;  ///< that both stand still and each was missed by the other drive
  bool both_trees = true;
};

/// Posterior probabilities of what became of the earlier object; they add up to 1.
struct ChangePosterior {
  double unchanged = 0.0;
  double changed_with_all = 0.0;  ///< same position, width changed as that of all trees
  double moved = 0.0;
  double width_changed = 0.0;
  double replaced = 0.0;      ///< it is gone, and the later one is new
  double not_repeated = 0.0;  ///< two things, each of which one drive only has seen
};

/// By Bayes' rule: the prior of each change is one tree in twenty; unchanged objects scatter as
/// `scatter`, with a few outliers; a moved one is anywhere within moved_max_m and as wide as
/// before; a new one is anywhere and as wide as any trunk.
ChangePosterior change_posterior(const PairObservation& pair, const PairScatter& scatter);

/// Fraction of outliers among the widths of unchanged pairs: trunks do not become thinner, so there
/// are as many upwards as are thinner by four standard errors. `deviations`: of width changes from
/// the common one, in standard errors. Shrunk to `expected`, which counts as `weight` pairs.
double outlier_fraction(const std::vector<double>& deviations, double expected, double weight);

/// Probability that an object is gone that was not observed, given the probability of a miss and
/// the probability `real` that it existed at all.
double confidence_of_absence(double probability_missed, double real);

}  // namespace orchard::mapping
