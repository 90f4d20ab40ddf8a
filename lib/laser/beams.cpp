// SPDX-License-Identifier: BSD-3-Clause
#include "laser/beams.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

using geometry::kPi;

/// Ranges below this are error codes (SCIP 2.0: 0 to 19 mm).
constexpr float kErrorCodes_m = 0.02f;
/// Fraction of the separating step that range noise may cause between neighbours on one surface.
constexpr double kSurfaceNoiseFraction = 0.5;

}  // namespace

Beams::Beams(const Scan& scan, const SegmentationConfig& config)
    : config_(config),
      size_(static_cast<std::ptrdiff_t>(scan.ranges_m.size())),
      step_rad_(std::abs(scan.bearing_step_rad)) {
  const double turn_rad = step_rad_ * static_cast<double>(size_);
  is_turn_ = size_ > 2 && std::abs(turn_rad - 2.0 * kPi) <= 1.5 * step_rad_;
  validate(scan);
  if (config.reflector != ReflectorUse::kIgnored && scan.has_intensities()) find_bright(scan);
  if (merges_occluded()) remove_foreground_clutter();
  if (is_turn_) start_ = first_gap();
  find_directions();
}

void Beams::find_directions() {
  const double c = std::cos(step_rad_), s = std::sin(step_rad_);
  directions_.resize(ranges_m_.size());
  // Rotated incrementally: cheaper than sin and cos per beam; the error is 1e-13 after 1000 beams.
  for (std::size_t i = 1; i < directions_.size(); ++i) {
    const Direction& last = directions_[i - 1];
    directions_[i] = {last.c * c - last.s * s, last.s * c + last.c * s};
  }
}

void Beams::validate(const Scan& scan) {
  const double nearest_m = std::max(scan.range_min_m, config_.range_min_m);
  const double farthest_m = std::min(scan.range_max_m, config_.range_max_m);
  ranges_m_.assign(scan.ranges_m.size(), 0.0f);
  blocked_.assign(scan.ranges_m.size(), 0);
  const BlindSector blind_sector = config_.blind_sector();
  const float no_return_m = static_cast<float>(scan.range_max_m);
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    if (blind_sector.contains(scan.bearing_rad(static_cast<double>(i)))) {
      blocked_[i] = 1;
    } else if (!(range_m >= kErrorCodes_m) || range_m == no_return_m) {
      // NaN, an error code, or exactly the maximum range, which some drivers send for no return
    } else if (range_m >= nearest_m && range_m <= farthest_m) {
      ranges_m_[i] = range_m;
    } else {
      // A surface that continues just beyond the maximum range has no visible end there.
      const bool cut_off = range_m > farthest_m && range_m <= farthest_m + jump_m(farthest_m);
      blocked_[i] = cut_off || range_m < nearest_m;
    }
  }
}

void Beams::find_bright(const Scan& scan) {
  bright_.assign(ranges_m_.size(), 0);
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    // a comparison with NaN is false
    if (!(ranges_m_[i] > 0.0f && scan.intensities[i] >= config_.reflectivity_min)) continue;
    bright_[i] = 1;
    has_bright_ = true;
  }
}

void Beams::remove_foreground_clutter() {
  std::vector<std::size_t> foregrounds;
  for (std::size_t i = 1; i + 1 < ranges_m_.size(); ++i) {
    const float before_m = ranges_m_[i - 1], here_m = ranges_m_[i], after_m = ranges_m_[i + 1];
    if (before_m <= 0.0f || here_m <= 0.0f || after_m <= 0.0f) continue;
    if (has_bright_ && bright_[i] != 0) continue;  // a thin pole that carries a reflector
    const double stands_out_m = kSurfaceNoiseFraction * jump_m(here_m);
    const float nearer_m = std::min(before_m, after_m);
    if (here_m < nearer_m - stands_out_m && std::abs(before_m - after_m) < stands_out_m &&
        joined(here_m, nearer_m)) {
      foregrounds.push_back(i);
    }
  }
  for (const std::size_t i : foregrounds) ranges_m_[i] = 0.0f;
}

std::ptrdiff_t Beams::first_gap() const {
  const auto at = [&](std::ptrdiff_t i) {
    return ranges_m_[static_cast<std::size_t>((i % size_ + size_) % size_)];
  };
  // No object extends across a gap, not even one that is merged behind foreground clutter.
  const std::ptrdiff_t across = std::max(config_.merge_occluded_beams, 1) + 1;
  const auto is_gap = [&](std::ptrdiff_t i) {
    for (std::ptrdiff_t before = 1; before <= across; ++before) {
      for (std::ptrdiff_t after = 0; before + after <= across; ++after) {
        if (joined(at(i - before), at(i + after))) return false;
      }
    }
    return true;
  };
  for (std::ptrdiff_t i = 0; i < size_; ++i) {
    if (is_gap(i)) return i;
  }
  return 0;
}

}  // namespace orchard::laser
