// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/hue_interval.hpp"

#include <cmath>
#include <stdexcept>

namespace orchard::calibration {
namespace {

constexpr int kHalfTurn = vision::kNumHues / 2;
constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

double wrap_hue_deg(double hue_deg) { return hue_deg - 360.0 * std::floor(hue_deg / 360.0); }

/// Index of the hue nearest to the circular mean.
int mean_hue(const vision::HueHistogram& hues) {
  double c = 0.0, s = 0.0;
  for (int hue = 0; hue < vision::kNumHues; ++hue) {
    const double angle_rad = hue * vision::kHueStep_deg * kRadPerDeg;
    c += hues.counts[static_cast<std::size_t>(hue)] * std::cos(angle_rad);
    s += hues.counts[static_cast<std::size_t>(hue)] * std::sin(angle_rad);
  }
  const double mean_deg = wrap_hue_deg(std::atan2(s, c) / kRadPerDeg);
  return static_cast<int>(std::lround(mean_deg / vision::kHueStep_deg)) % vision::kNumHues;
}

}  // namespace

void add(const vision::HueHistogram& hues, vision::HueHistogram& sum) {
  for (std::size_t hue = 0; hue < hues.counts.size(); ++hue) sum.counts[hue] += hues.counts[hue];
  sum.num_coloured += hues.num_coloured;
  sum.num_pixels += hues.num_pixels;
}

HueInterval hue_interval(const vision::HueHistogram& hues, double tail, double margin_deg) {
  if (hues.num_coloured <= 0)
    throw std::invalid_argument("no coloured pixels, so the hue is unknown");
  const int mean = mean_hue(hues);
  const auto count_at = [&](int offset) {
    const int hue = (mean + offset + 2 * vision::kNumHues) % vision::kNumHues;
    return hues.counts[static_cast<std::size_t>(hue)];
  };
  const double allowed = tail * hues.num_coloured;
  int low = -kHalfTurn, high = kHalfTurn - 1;
  for (double left_out = count_at(low); left_out <= allowed && low < high;) {
    left_out += count_at(++low);
  }
  for (double left_out = count_at(high); left_out <= allowed && high > low;) {
    left_out += count_at(--high);
  }
  HueInterval interval;
  interval.width_deg = (high - low) * vision::kHueStep_deg + 2.0 * margin_deg;
  if (interval.width_deg >= 360.0) return {0.0, 360.0, 360.0};
  interval.min_deg = wrap_hue_deg((mean + low) * vision::kHueStep_deg - margin_deg);
  interval.max_deg = wrap_hue_deg((mean + high) * vision::kHueStep_deg + margin_deg);
  return interval;
}

}  // namespace orchard::calibration
