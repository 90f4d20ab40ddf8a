// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/width_by_range.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace orchard::calibration {
namespace {

constexpr std::size_t kMaxBins = 6;
constexpr std::size_t kMinPerBin = 12;
/// Min ratio of farthest to nearest bin for a fit of the growth.
constexpr double kMinRatio = 1.5;

/// A bin and its mean of (range x step)^2, to which the growing part of the variance is
/// proportional.
struct Moments {
  WidthBin bin;
  double beam_m2 = 0.0;
};

Moments moments_of(const std::vector<WidthObservation>& observations, std::size_t first,
                   std::size_t last) {
  Moments m;
  m.bin = {observations[first].range_m, observations[last - 1].range_m,
           static_cast<int>(last - first), 0.0, 0.0};
  const auto n = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const double beam_m = observations[i].range_m * observations[i].beam_step_rad;
    m.bin.mean_m += observations[i].width_m / n;
    m.beam_m2 += beam_m * beam_m / n;
  }
  double squares_m2 = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    squares_m2 +=
        (observations[i].width_m - m.bin.mean_m) * (observations[i].width_m - m.bin.mean_m);
  }
  m.bin.sd_m = n > 1.0 ? std::sqrt(squares_m2 / (n - 1.0)) : 0.0;
  return m;
}

/// Fits variance = constant + growth x beam_m2; both >= 0.
std::pair<double, double> fit(const std::vector<Moments>& bins) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Moments& m : bins) {
    const double weight = m.bin.num_observations, variance = m.bin.sd_m * m.bin.sd_m;
    n += weight;
    x += weight * m.beam_m2;
    y += weight * variance;
    xx += weight * m.beam_m2 * m.beam_m2;
    xy += weight * m.beam_m2 * variance;
  }
  const double growth = (n * xy - x * y) / (n * xx - x * x);
  const double constant = (y - growth * x) / n;
  if (growth <= 0.0) return {y / n, 0.0};
  if (constant <= 0.0) return {0.0, xy / xx};
  return {constant, growth};
}

}  // namespace

WidthByRange width_by_range(std::vector<WidthObservation> observations) {
  WidthByRange result;
  if (observations.empty()) return result;
  std::sort(observations.begin(), observations.end(),
            [](const WidthObservation& a, const WidthObservation& b) {
              return std::tie(a.range_m, a.width_m) < std::tie(b.range_m, b.width_m);
            });
  const std::size_t num_bins =
      std::clamp<std::size_t>(observations.size() / kMinPerBin, std::size_t{1}, kMaxBins);
  std::vector<Moments> bins;
  for (std::size_t i = 0; i < num_bins; ++i) {
    bins.push_back(moments_of(observations, i * observations.size() / num_bins,
                              (i + 1) * observations.size() / num_bins));
    result.bins.push_back(bins.back().bin);
  }
  result.sd_m = moments_of(observations, 0, observations.size()).bin.sd_m;
  result.has_growth = num_bins >= 3 && bins.front().beam_m2 > 0.0 &&
                      bins.back().beam_m2 > kMinRatio * kMinRatio * bins.front().beam_m2;
  if (!result.has_growth) return result;
  const auto [constant, growth] = fit(bins);
  result.sd_m = std::sqrt(constant);
  result.sd_per_beam_step = std::sqrt(growth);
  return result;
}

}  // namespace orchard::calibration
