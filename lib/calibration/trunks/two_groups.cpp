// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/two_groups.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::calibration {
namespace {

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments moments_of(const std::vector<double>& values, std::size_t first, std::size_t last) {
  const auto n = static_cast<double>(last - first);
  Moments m;
  for (std::size_t i = first; i < last; ++i) m.mean += values[i] / n;
  for (std::size_t i = first; i < last; ++i) {
    m.variance += (values[i] - m.mean) * (values[i] - m.mean) / (n - 1.0);
  }
  return m;
}

}  // namespace

std::optional<TwoGroups> find_two_groups(std::vector<double> values, double min_fraction,
                                         double sd_floor) {
  if (values.size() < 4) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  const auto least =
      std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(min_fraction * n)));
  std::optional<TwoGroups> best;
  for (std::size_t cut = least; cut + least <= values.size(); ++cut) {
    const Moments low = moments_of(values, 0, cut);
    const Moments high = moments_of(values, cut, values.size());
    const double pooled = std::sqrt(0.5 * (low.variance + high.variance));
    const double separation = (high.mean - low.mean) / std::max({pooled, sd_floor, 1e-12});
    if (best && separation <= best->separation) continue;
    best = TwoGroups{0.5 * (values[cut - 1] + values[cut]), low.mean, high.mean,
                     static_cast<double>(cut) / n, separation};
  }
  return best;
}

}  // namespace orchard::calibration
