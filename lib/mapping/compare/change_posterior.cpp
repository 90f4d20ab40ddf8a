// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/change_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

constexpr double kThinner = -4.0;  ///< derived: standard errors; by chance one pair in 30,000

double normal(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

/// Density [1/m2] of a 2D normal distribution at `distance_m` from its mean; `sd` per axis.
double position_density(double distance_m, double sd) {
  const double u = distance_m / sd;
  return std::exp(-0.5 * u * u) / (2.0 * geometry::kPi * sd * sd);
}

/// Density of a width change (two-sided exponential).
double change_of_width(double change_m, double scale_m) {
  return std::exp(-std::abs(change_m) / scale_m) / (2.0 * scale_m);
}

}  // namespace

ChangePosterior change_posterior(const PairObservation& pair, const PairScatter& scatter) {
  const double position_sd_m = pair.noise_factor * scatter.position_sd_m;
  const double width_sd_m =
      pair.width_sd_m > 0.0 ? pair.width_sd_m : pair.noise_factor * scatter.width_sd_m;
  const double width_outliers =
      pair.both_trees ? scatter.width_outliers_of_trees : scatter.width_outliers_of_others;
  const double position_outliers =
      pair.both_trees ? tuning::kPositionOutliersOfTrees : tuning::kPositionOutliersOfOthers;
  const double there = position_density(pair.distance_m, position_sd_m);
  const double as_wide = normal(pair.width_change_m, width_sd_m);
  const double as_wide_as_all = normal(pair.width_change_m - scatter.width_common_m, width_sd_m);
  const double still = 1.0 - 3.0 * kChangedFraction;

  ChangePosterior posterior;
  const double displaced =
      position_outliers *
      position_density(pair.distance_m, std::hypot(position_sd_m, tuning::kOutlierPosition_m));
  posterior.unchanged =
      still *
      ((1.0 - width_outliers - position_outliers) * there * as_wide +
       width_outliers *
           position_density(pair.distance_m, std::hypot(position_sd_m, tuning::kBushPosition_m)) *
           change_of_width(pair.width_change_m, tuning::kOutlierScale_m) +
       displaced * as_wide);
  posterior.changed_with_all = still * displaced * std::max(0.0, as_wide_as_all - as_wide);
  posterior.width_changed =
      kChangedFraction * there * change_of_width(pair.width_change_m, tuning::kGrowthScale_m);
  posterior.moved = kChangedFraction * as_wide_as_all /
                    (geometry::kPi * scatter.moved_max_m * scatter.moved_max_m);
  const double others_per_m2 = 1.0 / (2.0 * scatter.spacing_m * scatter.spacing_m);
  const double another =
      others_per_m2 * normal(pair.width_b_m - scatter.width_mean_m, scatter.width_spread_m);
  posterior.replaced = kChangedFraction * kChangedFraction * another;
  posterior.not_repeated = still * still * pair.not_repeated * another;
  const double sum = posterior.unchanged + posterior.changed_with_all + posterior.width_changed +
                     posterior.moved + posterior.replaced + posterior.not_repeated;
  if (!(sum > 1e-200)) return {0.0, 0.0, 0.0, 0.0, 1.0, 0.0};  // all densities underflow
  posterior.unchanged /= sum;
  posterior.changed_with_all /= sum;
  posterior.width_changed /= sum;
  posterior.moved /= sum;
  posterior.replaced /= sum;
  posterior.not_repeated /= sum;
  return posterior;
}

double outlier_fraction(const std::vector<double>& deviations, double expected, double weight) {
  const auto num_thinner = std::count_if(deviations.begin(), deviations.end(),
                                         [](double deviation) { return deviation < kThinner; });
  const double fraction = (2.0 * static_cast<double>(num_thinner) + weight * expected) /
                          (static_cast<double>(deviations.size()) + weight);
  return std::min(fraction, tuning::kOutliersMax);
}

double confidence_of_absence(double probability_missed, double real) {
  return real * kChangedFraction /
         (kChangedFraction + (1.0 - kChangedFraction) * std::min(1.0, probability_missed));
}

}  // namespace orchard::mapping
