// SPDX-License-Identifier: BSD-3-Clause
#include "laser/layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace orchard::laser {
namespace {

/// derived: the lowest part of the plane's height that is looked at: 0.2 m of 0.3 m, above the
/// grass of a mown aisle.
constexpr double kLowest = 2.0 / 3.0;

/// derived: three standard deviations of a range (3 cm by the data sheet of a VLP-16): what stands
/// where two layers meet is seen by one of them.
constexpr double kOverlap_m = 0.1;

/// derived: fine against kOverlap_m.
constexpr double kStep_m = 0.01;

constexpr std::size_t kMaxLayers = 32;  // derived: the bits of a mask

std::uint32_t bit(std::size_t layer) { return std::uint32_t{1} << layer; }

/// The layer that tells of the plane at a distance.
std::optional<std::size_t> owner_at(const LayerGeometry& g, double level_m) {
  std::optional<std::size_t> owner;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < g.elevations_rad.size(); ++i) {
    const double height_m = g.scanner_height_m + level_m * std::tan(g.elevations_rad[i]);
    const double off_m = std::abs(height_m - g.plane_height_m);
    if (height_m < kLowest * g.plane_height_m || off_m >= nearest_m) continue;
    nearest_m = off_m;
    owner = i;
  }
  return owner;
}

}  // namespace

LayerPlan::LayerPlan(const LayerGeometry& geometry) : own_(geometry.elevations_rad.size()) {
  if (own_.size() > kMaxLayers) throw std::invalid_argument("a scanner of more than 32 layers");
  const int num_steps = static_cast<int>(kReach_m / kStep_m);
  for (int step = 1; step <= num_steps; ++step) {
    const double level_m = kStep_m * step;
    const std::optional<std::size_t> owner = owner_at(geometry, level_m);
    if (!owner) continue;
    Interval& own = own_[*owner];
    if (own.is_empty()) own.from_m = level_m - kStep_m;
    own.to_m = level_m;
    if (level_m <= 0.5 * kReach_m) needed_ |= bit(*owner);
  }
  for (Interval& own : own_) {
    if (own.is_empty()) continue;
    own.from_m = std::max(0.0, own.from_m - kOverlap_m);
    own.to_m += kOverlap_m;
  }
}

void JoinedTurn::add(std::size_t beam, std::size_t layer, float level_m, std::uint8_t intensity) {
  Beam& b = beams_[beam];
  const bool returns = level_m > 0.0f;
  switch (returns ? plan_->of(layer, level_m) : LayerPlan::Says::kPast) {
    case LayerPlan::Says::kPast:
      b.passed |= bit(layer);
      break;
    case LayerPlan::Says::kReturn:
      if (b.level_m > 0.0f && b.level_m <= level_m) break;
      b.level_m = level_m;
      b.intensity = intensity;
      break;
    case LayerPlan::Says::kNothing:
      break;
  }
}

void JoinedTurn::write_to(Scan& scan) const {
  scan.range_max_m = LayerPlan::kReach_m;
  scan.ranges_m.resize(beams_.size());
  scan.intensities.resize(beams_.size());
  const std::uint32_t needed = plan_->needed();
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const Beam& b = beams_[i];
    const bool is_free = (b.passed & needed) == needed;
    const float no_return_m = is_free ? 0.0f : std::numeric_limits<float>::quiet_NaN();
    scan.ranges_m[i] = b.level_m > 0.0f ? b.level_m : no_return_m;
    scan.intensities[i] = static_cast<float>(b.intensity);
  }
}

}  // namespace orchard::laser
