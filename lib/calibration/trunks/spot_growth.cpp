// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/spot_growth.hpp"

#include <cmath>
#include <cstddef>
#include <map>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

constexpr std::size_t kFewestThings = 3;
/// Standard errors from which on a growth is none by chance.
constexpr double kSignificant = 3.0;

struct Weighted {
  double range_m = 0.0, width_m = 0.0, weight = 0.0;
};

/// A trunk's looks with one beam to spare, by its width in the nearer half of them.
std::vector<Weighted> usable(std::vector<SpotLook> looks, int fewest_beams) {
  std::vector<double> ranges_m, widths_m;
  for (const SpotLook& look : looks) ranges_m.push_back(look.range_m);
  const double middle_m = geometry::median(std::move(ranges_m));
  for (const SpotLook& look : looks) {
    if (look.range_m <= middle_m) widths_m.push_back(look.width_m);
  }
  const double width_m = geometry::median(std::move(widths_m));
  std::vector<Weighted> used;
  for (const SpotLook& look : looks) {
    const double beam_m = look.range_m * std::abs(look.beam_step_rad);
    if (width_m < (fewest_beams + 1) * beam_m) continue;
    used.push_back({look.range_m, look.width_m, 6.0 / (beam_m * beam_m)});
  }
  return used;
}

}  // namespace

bool SpotGrowth::significant() const { return std::abs(divergence_rad) > kSignificant * se_rad; }

std::optional<SpotGrowth> spot_growth(const std::vector<SpotLook>& looks, int fewest_beams) {
  std::map<int, std::vector<SpotLook>> of_thing;
  for (const SpotLook& look : looks) of_thing[look.thing].push_back(look);
  // about each trunk's own means; what one trunk's looks get wrong they get wrong together
  struct Sums {
    double xx = 0.0, xy = 0.0;
  };
  std::vector<Sums> sums;
  double xx = 0.0, xy = 0.0;
  for (const auto& [thing, all] : of_thing) {
    const std::vector<Weighted> used = usable(all, fewest_beams);
    double weight = 0.0, range_m = 0.0, width_m = 0.0;
    for (const Weighted& look : used) {
      weight += look.weight;
      range_m += look.weight * look.range_m;
      width_m += look.weight * look.width_m;
    }
    if (used.size() < 2) continue;
    range_m /= weight;
    width_m /= weight;
    Sums of_this;
    for (const Weighted& look : used) {
      const double x_m = look.range_m - range_m;
      of_this.xx += look.weight * x_m * x_m;
      of_this.xy += look.weight * x_m * (look.width_m - width_m);
    }
    xx += of_this.xx;
    xy += of_this.xy;
    sums.push_back(of_this);
  }
  if (sums.size() < kFewestThings || !(xx > 0.0)) return std::nullopt;
  SpotGrowth growth;
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
