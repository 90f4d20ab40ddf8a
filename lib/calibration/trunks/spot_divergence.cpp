// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/spot_divergence.hpp"

#include <cmath>
#include <cstddef>
#include <map>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

constexpr std::size_t kFewestThings = 3;
/// Min growth in standard errors to be significant.
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
