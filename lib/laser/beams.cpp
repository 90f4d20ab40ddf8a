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

}  // namespace

Beams::Beams(const Scan& scan, const SegmentationConfig& config)
    : config_(config),
      size_(static_cast<std::ptrdiff_t>(scan.ranges_m.size())),
      step_rad_(std::abs(scan.bearing_step_rad)),
      step_{std::cos(step_rad_), std::sin(step_rad_)} {
  const double turn_rad = step_rad_ * static_cast<double>(size_);
  is_turn_ = size_ > 2 && std::abs(turn_rad - 2.0 * kPi) <= 1.5 * step_rad_;
  validate(scan);
  if (config.reflector != ReflectorUse::kIgnored && scan.has_intensities()) find_bright(scan);
  if (is_turn_) start_ = first_gap();
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

std::ptrdiff_t Beams::first_gap() const {
  const auto at = [&](std::ptrdiff_t i) {
    return ranges_m_[static_cast<std::size_t>((i % size_ + size_) % size_)];
  };
  constexpr std::ptrdiff_t across = 2;  // one missing beam inside an object is bridged
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
