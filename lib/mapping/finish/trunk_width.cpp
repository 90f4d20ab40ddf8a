// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/trunk_width.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

/// physical: young and old trunks of one planting are within this factor of their middle.
constexpr double kAlike = 2.0;
/// derived: a median of these is known to a seventh of their spread.
constexpr std::size_t kTrunksMin = 8;
constexpr int kViewsMin = 5;
/// derived: the share of widths within kAlike of one, if they were anywhere between a centimetre
/// and a metre: 2 log 2 / log 100.
constexpr double kShareByChance = 0.30;

/// Ascending widths of what is round; of that in rows alone, if so much stands in rows.
std::vector<double> round_widths_m(const std::vector<Landmark>& landmarks) {
  std::vector<double> widths_m, in_rows_m;
  for (const Landmark& l : landmarks) {
    const bool is_round = l.length_m == 0.0 && l.width_m > 0.0;
    if (!is_round || l.num_observations < kViewsMin) continue;
    widths_m.push_back(l.width_m);
    if (l.row > 0) in_rows_m.push_back(l.width_m);
  }
  if (in_rows_m.size() >= kTrunksMin) widths_m = std::move(in_rows_m);
  std::sort(widths_m.begin(), widths_m.end());
  return widths_m;
}

}  // namespace

std::optional<TrunkWidth> trunk_width_of(const std::vector<Landmark>& landmarks) {
  const std::vector<double> widths_m = round_widths_m(landmarks);
  std::vector<double> most;
  for (const double middle_m : widths_m) {
    const auto first = std::lower_bound(widths_m.begin(), widths_m.end(), middle_m / kAlike);
    const auto last = std::upper_bound(widths_m.begin(), widths_m.end(), middle_m * kAlike);
    if (static_cast<std::size_t>(last - first) > most.size()) most.assign(first, last);
  }
  const auto num = static_cast<double>(most.size());
  if (most.size() < kTrunksMin ||
      num < 1.5 * kShareByChance * static_cast<double>(widths_m.size())) {
    return std::nullopt;
  }
  TrunkWidth width;
  width.num_trunks = static_cast<int>(most.size());
  width.mean_m = geometry::median(most);
  std::vector<double> deviations_m;
  for (const double w : most) deviations_m.push_back(w - width.mean_m);
  width.sd_m = geometry::robust_sd(std::move(deviations_m));
  width.mean_se_m = width.sd_m / std::sqrt(num);
  return width;
}

}  // namespace orchard::mapping
