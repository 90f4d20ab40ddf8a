// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/terrain.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

// physical: ISO 8608:2016. Its spectral density of displacement falls with the square of the
// spatial frequency and is stated at 0.1 cycles/m. Off-road profiles begin at 0.05 cycles/m (longer
// waves are the slope); above 2.83 cycles/m a wheel bridges the bumps.
constexpr double kStatedAt_perm = 0.1;
constexpr double kLowest_perm = 0.05;
constexpr double kHighest_perm = 2.83;

/// derived: one wave per third of an octave, the finest band of the standard.
constexpr double kWavesPerOctave = 3.0;

/// derived: banks of earth stand at 45 degrees on average.
constexpr double kBankSlope = 1.0;

// derived: standard deviations that a normal number exceeds once in 30,000; of slopes half as many,
// as steps of a decimetre average most of the variance of slopes, which is that of the shortest
// bumps.
constexpr double kHardlyExceeded = 4.0;
constexpr double kHardlySteeper = 2.0;

}  // namespace

Terrain::Terrain(std::uint64_t seed, const TerrainConfig& config)
    : slope_(0.01 * config.slope_across_percent, 0.01 * config.slope_along_percent),
      terrace_height_m_(config.terrace_height_m),
      terrace_width_m_(config.terrace_width_m),
      bank_m_(std::min(config.terrace_height_m / kBankSlope, config.terrace_width_m)) {
  if (config.roughness_m3 > 0.0) add_bumps(seed, config.roughness_m3);
  // The steepest of a bank, of u^2 (3 - 2 u), is 1.5 times its mean.
  if (terrace_height_m_ > 0.0) bank_steepness_ = 1.5 * terrace_height_m_ / bank_m_;
  double height_m2 = 0.0, slope_2 = 0.0;
  for (const Wave& w : waves_) {
    height_m2 += 0.5 * w.amplitude_m * w.amplitude_m;
    slope_2 += 0.5 * std::pow(w.amplitude_m * std::hypot(w.kx_radpm, w.ky_radpm), 2);
  }
  bump_max_m_ = kHardlyExceeded * std::sqrt(height_m2);
  bump_steepness_ = kHardlySteeper * std::sqrt(slope_2);
}

/// A wave of frequency n in a direction at the angle a to a line is met there at n |cos a|, so that
/// waves of density S(n) = c / n^2 in all directions make profiles of density S(n) mean|cos a|, and
/// mean|cos a| = 2 / pi.
void Terrain::add_bumps(std::uint64_t seed, double roughness_m3) {
  Random random(seed, Stream::kTerrain);
  const double c_m = 0.5 * geometry::kPi * roughness_m3 * kStatedAt_perm * kStatedAt_perm;
  const double octaves = std::log2(kHighest_perm / kLowest_perm);
  const int num_waves = static_cast<int>(std::ceil(kWavesPerOctave * octaves));
  const double ratio = std::pow(kHighest_perm / kLowest_perm, 1.0 / num_waves);
  double low_perm = kLowest_perm;
  // By the golden angle few waves come from all directions, neighbouring ones from different ones.
  const double golden_rad = geometry::kPi * (3.0 - std::sqrt(5.0));
  double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
  for (int i = 0; i < num_waves; ++i) {
    towards_rad += golden_rad;
    const double high_perm = low_perm * ratio;
    const double k_radpm = 2.0 * geometry::kPi * low_perm * std::pow(ratio, random.uniform());
    const double phase_rad = random.uniform(-geometry::kPi, geometry::kPi);
    const double variance_m2 = c_m * (1.0 / low_perm - 1.0 / high_perm);
    waves_.push_back({k_radpm * std::cos(towards_rad), k_radpm * std::sin(towards_rad),
                      std::sqrt(2.0 * variance_m2), phase_rad});
    low_perm = high_perm;
  }
}

/// Bank k is centred at k + 1/2 terraces, and the terrace of x = 0 is level with the map.
Terrain::Bank Terrain::bank_at(double x_m) const {
  const double terrace = std::floor(x_m / terrace_width_m_);
  const double off_m = x_m - (terrace + 0.5) * terrace_width_m_;
  return {terrace, std::clamp(off_m / bank_m_ + 0.5, 0.0, 1.0)};
}

double Terrain::graded_m(double x_m, double y_m) const {
  const double z_m = slope_.x() * x_m + slope_.y() * y_m;
  if (terrace_height_m_ <= 0.0) return z_m;
  const auto [terrace, u] = bank_at(x_m);
  return z_m + terrace_height_m_ * (terrace + u * u * (3.0 - 2.0 * u));
}

double Terrain::bump_m(double x_m, double y_m) const {
  double z_m = 0.0;
  for (const Wave& w : waves_) {
    z_m += w.amplitude_m * std::sin(w.kx_radpm * x_m + w.ky_radpm * y_m + w.phase_rad);
  }
  return z_m;
}

Eigen::Vector2d Terrain::gradient(double x_m, double y_m) const {
  Eigen::Vector2d slope = slope_;
  if (terrace_height_m_ > 0.0) {
    const double u = bank_at(x_m).fraction;
    slope.x() += terrace_height_m_ * 6.0 * u * (1.0 - u) / bank_m_;
  }
  for (const Wave& w : waves_) {
    const double rise = w.amplitude_m * std::cos(w.kx_radpm * x_m + w.ky_radpm * y_m + w.phase_rad);
    slope += rise * Eigen::Vector2d(w.kx_radpm, w.ky_radpm);
  }
  return slope;
}

}  // namespace orchard::simulation
