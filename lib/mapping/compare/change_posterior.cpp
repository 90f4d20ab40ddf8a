// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/change_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

constexpr double kGrowthScale_m = 0.05;       ///< of widths that changed (exponential)
constexpr double kStrayScale_m = 0.1;         ///< of widths that are off
constexpr double kStrayPlace_m = 0.1;         ///< of places that are off, per axis
constexpr double kStrayPlacesOfTrees = 0.01;  ///< share of unchanged pairs
constexpr double kStrayPlacesOfOthers = 0.05;
constexpr double kStrayMost = 0.3;
constexpr double kBushPlace_m = 0.03;  ///< where the width of a thing is off, its place is, too
constexpr double kThinner = -4.0;      ///< standard errors

double normal(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

/// Density [1/m2] of a place that far away, each axis scattering by sd.
double place(double distance_m, double sd) {
  const double u = distance_m / sd;
  return std::exp(-0.5 * u * u) / (2.0 * geometry::kPi * sd * sd);
}

/// Density of a change of width either way.
double change_of_width(double change_m, double scale_m) {
  return std::exp(-std::abs(change_m) / scale_m) / (2.0 * scale_m);
}

}  // namespace

PairOdds odds_of(const PairSight& pair, const PairScatter& scatter) {
  const double position_sd_m = pair.noise_factor * scatter.position_sd_m;
  const double width_sd_m = pair.noise_factor * scatter.width_sd_m;
  const double stray_widths =
      pair.both_trees ? scatter.stray_widths_of_trees : scatter.stray_widths_of_others;
  const double stray_places = pair.both_trees ? kStrayPlacesOfTrees : kStrayPlacesOfOthers;
  const double there = place(pair.distance_m, position_sd_m);
  const double as_wide = normal(pair.width_change_m, width_sd_m);
  const double as_wide_as_all = normal(pair.width_change_m - scatter.width_common_m, width_sd_m);
  const double still = 1.0 - 3.0 * kShareChanged;

  PairOdds odds;
  const double strayed =
      stray_places * place(pair.distance_m, std::hypot(position_sd_m, kStrayPlace_m));
  odds.unchanged =
      still * ((1.0 - stray_widths - stray_places) * there * as_wide +
               stray_widths * place(pair.distance_m, std::hypot(position_sd_m, kBushPlace_m)) *
                   change_of_width(pair.width_change_m, kStrayScale_m) +
               strayed * as_wide);
  odds.changed_with_all = still * strayed * std::max(0.0, as_wide_as_all - as_wide);
  odds.width_changed = kShareChanged * there * change_of_width(pair.width_change_m, kGrowthScale_m);
  odds.moved =
      kShareChanged * as_wide_as_all / (geometry::kPi * scatter.moved_max_m * scatter.moved_max_m);
  const double new_per_m2 = kShareChanged / (2.0 * scatter.spacing_m * scatter.spacing_m);
  odds.replaced = kShareChanged * new_per_m2 *
                  normal(pair.width_b_m - scatter.width_mean_m, scatter.width_spread_m);
  const double sum =
      odds.unchanged + odds.changed_with_all + odds.width_changed + odds.moved + odds.replaced;
  if (!(sum > 1e-200)) return {0.0, 0.0, 0.0, 0.0, 1.0};  // like nothing that is known
  odds.unchanged /= sum;
  odds.changed_with_all /= sum;
  odds.width_changed /= sum;
  odds.moved /= sum;
  odds.replaced /= sum;
  return odds;
}

double stray_share(const std::vector<double>& deviations, double expected, double weight) {
  const auto num_thinner = std::count_if(deviations.begin(), deviations.end(),
                                         [](double deviation) { return deviation < kThinner; });
  const double share = (2.0 * static_cast<double>(num_thinner) + weight * expected) /
                       (static_cast<double>(deviations.size()) + weight);
  return std::min(share, kStrayMost);
}

double confidence_of_absence(double probability_missed, double real) {
  return real * kShareChanged /
         (kShareChanged + (1.0 - kShareChanged) * std::min(1.0, probability_missed));
}

}  // namespace orchard::mapping
