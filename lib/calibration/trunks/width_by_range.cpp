// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/width_by_range.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

// derived: 12 observations give a scatter to 20 %; its t distribution has a variance from 4 on.
constexpr std::size_t kMaxBins = 6;
constexpr std::size_t kMinPerBin = 12;

/// Min ratio of farthest to nearest bin for a fit of the growth.
constexpr double kMinRatio = 1.5;
/// derived: the predictive t distribution has a variance from so many trunks on.
constexpr double kMinTrunks = 4.0;

/// The observations of one trunk.
struct TrunkSum {
  double n = 0.0;
  double mean_m = 0.0;
  double mean_variance_m2 = 0.0;  ///< of its mean by the scatter of its observations
};

/// The variance of observations about their trunk's mean at about one range. The growing part is
/// proportional to beam_m2, the mean of (range x step)^2.
struct Scatter {
  double n = 0.0;
  double beam_m2 = 0.0;
  double variance_m2 = 0.0;
};

/// variance = constant + growth x beam_m2; both >= 0.
struct Law {
  double constant_m2 = 0.0;
  double growth = 0.0;
};

std::size_t num_bins_of(std::size_t num_observations) {
  return std::clamp<std::size_t>(num_observations / kMinPerBin, std::size_t{1}, kMaxBins);
}

double beam_m2(const WidthObservation& observation) {
  return geometry::square(observation.range_m * observation.beam_step_rad);
}

WidthBin bin_of(const std::vector<WidthObservation>& observations, std::size_t first,
                std::size_t last) {
  WidthBin bin{observations[first].range_m, observations[last - 1].range_m,
               static_cast<int>(last - first), 0.0, 0.0};
  const auto n = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) bin.mean_m += observations[i].width_m / n;
  double squares_m2 = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    squares_m2 += geometry::square(observations[i].width_m - bin.mean_m);
  }
  bin.sd_m = n > 1.0 ? std::sqrt(squares_m2 / (n - 1.0)) : 0.0;
  return bin;
}

std::map<int, TrunkSum> trunks_of(const std::vector<WidthObservation>& observations) {
  std::map<int, TrunkSum> trunks;
  for (const WidthObservation& observation : observations) {
    TrunkSum& trunk = trunks[observation.trunk];
    trunk.n += 1.0;
    trunk.mean_m += (observation.width_m - trunk.mean_m) / trunk.n;
  }
  return trunks;
}

/// The scatter within trunks, in bins of range; empty if each trunk was observed once.
std::vector<Scatter> scatter_of(const std::vector<WidthObservation>& observations,
                                const std::map<int, TrunkSum>& trunks) {
  std::vector<Scatter> each;
  for (const WidthObservation& observation : observations) {
    const TrunkSum& trunk = trunks.at(observation.trunk);
    if (trunk.n < 2.0) continue;
    each.push_back(
        {1.0, beam_m2(observation),
         geometry::square(observation.width_m - trunk.mean_m) * trunk.n / (trunk.n - 1.0)});
  }
  std::vector<Scatter> bins;
  const std::size_t num_bins = each.empty() ? 0 : num_bins_of(each.size());
  for (std::size_t b = 0; b < num_bins; ++b) {
    Scatter bin;
    for (std::size_t i = b * each.size() / num_bins; i < (b + 1) * each.size() / num_bins; ++i) {
      bin.n += 1.0;
      bin.beam_m2 += (each[i].beam_m2 - bin.beam_m2) / bin.n;
      bin.variance_m2 += (each[i].variance_m2 - bin.variance_m2) / bin.n;
    }
    bins.push_back(bin);
  }
  return bins;
}

bool spans_ranges(const std::vector<Scatter>& bins) {
  return bins.size() >= 3 && bins.front().beam_m2 > 0.0 &&
         bins.back().beam_m2 > kMinRatio * kMinRatio * bins.front().beam_m2;
}

Law fit(const std::vector<Scatter>& bins) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Scatter& bin : bins) {
    n += bin.n;
    x += bin.n * bin.beam_m2;
    y += bin.n * bin.variance_m2;
    xx += bin.n * bin.beam_m2 * bin.beam_m2;
    xy += bin.n * bin.beam_m2 * bin.variance_m2;
  }
  if (n <= 0.0) return {};
  if (!spans_ranges(bins)) return {y / n, 0.0};
  const double growth = (n * xy - x * y) / (n * xx - x * x);
  const double constant_m2 = (y - growth * x) / n;
  if (growth <= 0.0) return {y / n, 0.0};
  if (constant_m2 <= 0.0) return {0.0, xy / xx};
  return {constant_m2, growth};
}

/// Variance of another trunk's width about the mean of these [m^2].
double variance_between(const std::vector<WidthObservation>& observations,
                        std::map<int, TrunkSum> trunks, const Law& within) {
  for (const WidthObservation& observation : observations) {
    TrunkSum& trunk = trunks.at(observation.trunk);
    trunk.mean_variance_m2 +=
        (within.constant_m2 + within.growth * beam_m2(observation)) / (trunk.n * trunk.n);
  }
  const auto k = static_cast<double>(trunks.size());
  if (k < 2.0) return 0.0;
  double mean_m = 0.0, squares_m2 = 0.0, of_means_m2 = 0.0;
  for (const auto& [number, trunk] : trunks) mean_m += trunk.mean_m / k;
  for (const auto& [number, trunk] : trunks) {
    squares_m2 += geometry::square(trunk.mean_m - mean_m) / (k - 1.0);
    of_means_m2 += trunk.mean_variance_m2 / k;
  }
  const double between_m2 = std::max(0.0, squares_m2 - of_means_m2);
  if (k < kMinTrunks) return between_m2;
  return between_m2 * (1.0 + 1.0 / k) * (k - 1.0) / (k - 3.0);
}

}  // namespace

WidthByRange width_by_range(std::vector<WidthObservation> observations) {
  WidthByRange result;
  if (observations.empty()) return result;
  std::sort(observations.begin(), observations.end(),
            [](const WidthObservation& a, const WidthObservation& b) {
              return std::tie(a.range_m, a.width_m, a.trunk) <
                     std::tie(b.range_m, b.width_m, b.trunk);
            });
  const std::size_t num_bins = num_bins_of(observations.size());
  for (std::size_t i = 0; i < num_bins; ++i) {
    result.bins.push_back(bin_of(observations, i * observations.size() / num_bins,
                                 (i + 1) * observations.size() / num_bins));
  }
  const std::map<int, TrunkSum> trunks = trunks_of(observations);
  const std::vector<Scatter> scatter = scatter_of(observations, trunks);
  const Law within = fit(scatter);
  result.has_growth = spans_ranges(scatter);
  result.sd_per_beam_step = std::sqrt(within.growth);
  result.sd_m = std::sqrt(within.constant_m2 + variance_between(observations, trunks, within));
  return result;
}

namespace {

// derived: a scatter of means needs three; 3 sigma.
constexpr std::size_t kFewestThings = 3;
/// derived: min growth in standard errors: chance 0.003.
constexpr double kSignificant = 3.0;

struct Weighted {
  double range_m = 0.0, width_m = 0.0, weight = 0.0;
};

/// Selects a trunk's observations at ranges where it has at least one beam more than the minimum,
/// by its width in the nearer half of the observations.
std::vector<Weighted> usable(std::vector<SpotWidth> observations, int min_beams) {
  std::vector<double> ranges_m, widths_m;
  for (const SpotWidth& observation : observations) ranges_m.push_back(observation.range_m);
  const double middle_m = geometry::median(std::move(ranges_m));
  for (const SpotWidth& observation : observations) {
    if (observation.range_m <= middle_m) widths_m.push_back(observation.width_m);
  }
  const double width_m = geometry::median(std::move(widths_m));
  std::vector<Weighted> used;
  for (const SpotWidth& observation : observations) {
    const double beam_m = observation.range_m * std::abs(observation.beam_step_rad);
    if (width_m < (min_beams + 1) * beam_m) continue;
    used.push_back({observation.range_m, observation.width_m, 6.0 / (beam_m * beam_m)});
  }
  return used;
}

}  // namespace

bool SpotDivergence::significant() const {
  return std::abs(divergence_rad) > kSignificant * se_rad;
}

std::optional<SpotDivergence> fit_spot_divergence(const std::vector<SpotWidth>& observations,
                                                  int min_beams) {
  std::map<int, std::vector<SpotWidth>> of_object;
  for (const SpotWidth& observation : observations)
    of_object[observation.object].push_back(observation);
  // Sums about each trunk's own means, kept per trunk: errors within a trunk are correlated.
  struct Sums {
    double xx = 0.0, xy = 0.0;
  };
  std::vector<Sums> sums;
  double xx = 0.0, xy = 0.0;
  for (const auto& [object, all] : of_object) {
    const std::vector<Weighted> used = usable(all, min_beams);
    double weight = 0.0, range_m = 0.0, width_m = 0.0;
    for (const Weighted& observation : used) {
      weight += observation.weight;
      range_m += observation.weight * observation.range_m;
      width_m += observation.weight * observation.width_m;
    }
    if (used.size() < 2) continue;
    range_m /= weight;
    width_m /= weight;
    Sums of_this;
    for (const Weighted& observation : used) {
      const double x_m = observation.range_m - range_m;
      of_this.xx += observation.weight * x_m * x_m;
      of_this.xy += observation.weight * x_m * (observation.width_m - width_m);
    }
    xx += of_this.xx;
    xy += of_this.xy;
    sums.push_back(of_this);
  }
  if (sums.size() < kFewestThings || !(xx > 0.0)) return std::nullopt;
  SpotDivergence growth;
  growth.divergence_rad = xy / xx;
  double scores = 0.0;
  for (const Sums& s : sums) {
    const double score = s.xy - growth.divergence_rad * s.xx;
    scores += score * score;
  }
  const double n = static_cast<double>(sums.size());
  growth.se_rad = std::sqrt(scores * n / (n - 1.0)) / xx;
  return growth;
}

}  // namespace orchard::calibration
