// SPDX-License-Identifier: BSD-3-Clause
#include "laser/range_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/statistics.hpp"
#include "text/number_text.hpp"

namespace orchard::laser {
namespace {

/// derived: neighbouring scans see the same surfaces.
constexpr int kScanStep = 5;
/// derived: a quarter of these is enough for a quantile known to a tenth.
constexpr std::size_t kSurfacesMin = 60;
constexpr std::size_t kSurfacesMax = 1000;
/// derived: with a fifth left out at each side, where a trunk turns away, three differences remain.
constexpr std::size_t kBeamsMin = 9;
constexpr std::size_t kSides = 5;
/// derived: standard deviation of r0 - 3 r1 + 3 r2 - r3 for independent ranges of 1: root of
/// 1 + 9 + 9 + 1.
const double kThirdDifferenceSd = std::sqrt(20.0);
/// derived: of the smoothest quarter, so that leaves have no say.
constexpr double kSmooth = 0.25;
/// physical: a circle is refused at twice the noise (chi2 per degree of freedom of four).
constexpr double kTooLarge = 2.0;

}  // namespace

void RangeNoise::add(const Scan& scan) {
  if (ratios_.size() >= kSurfacesMax || num_scans_++ % kScanStep != 0) return;
  const auto& ranges_m = scan.ranges_m;
  const auto is_usable = [&](std::size_t i) {
    return scan.valid(i) && ranges_m[i] <= range_max_m_ &&
           !blind_.contains(scan.bearing_rad(static_cast<double>(i)));
  };
  for (std::size_t first = 0; first < ranges_m.size();) {
    if (!is_usable(first)) {
      ++first;
      continue;
    }
    std::size_t end = first + 1;
    while (end < ranges_m.size() && is_usable(end) &&
           std::abs(static_cast<double>(ranges_m[end]) - ranges_m[end - 1]) < jump_m_) {
      ++end;
    }
    if (end - first >= kBeamsMin) {
      const std::size_t side = (end - first) / kSides;
      add_surface(scan, first + side, end - side);
    }
    first = end;
  }
}

void RangeNoise::add_surface(const Scan& scan, std::size_t first, std::size_t end) {
  const auto range_m = [&scan](std::size_t i) { return static_cast<double>(scan.ranges_m[i]); };
  std::vector<double> differences_m;
  for (std::size_t i = first; i + 3 < end; ++i) {
    differences_m.push_back(range_m(i) - 3.0 * range_m(i + 1) + 3.0 * range_m(i + 2) -
                            range_m(i + 3));
  }
  const double stated_m = laser_.range_sd_at(range_m((first + end) / 2));
  if (!(stated_m > 0.0)) return;
  ratios_.push_back(geometry::robust_sd(std::move(differences_m)) / kThirdDifferenceSd / stated_m);
}

std::optional<double> RangeNoise::ratio() const {
  if (ratios_.size() < kSurfacesMin) return std::nullopt;
  return geometry::quantile(ratios_, kSmooth);
}

std::optional<Finding> RangeNoise::finding() const {
  const std::optional<double> noise = ratio();
  if (!noise || *noise < kTooLarge) return std::nullopt;
  return Finding{"range_sd", "laser.range_sd_m",
                 "on smooth surfaces ranges scatter " + fixed_text(*noise, 1) +
                     " times as much as laser.range_sd_m " + shortest_text(laser_.range_sd_m) +
                     " and range_sd_fraction " + shortest_text(laser_.range_sd_fraction) +
                     " say: trunks are taken for rough things; " +
                     fixed_text(*noise * laser_.range_sd_m, 4) + " and " +
                     fixed_text(*noise * laser_.range_sd_fraction, 4) + " would fit"};
}

}  // namespace orchard::laser
