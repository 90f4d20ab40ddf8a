// SPDX-License-Identifier: BSD-3-Clause
#include "pose/sight_field.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::pose {
namespace {

/// What lies this much behind a sighting is behind it, not it.
constexpr double kBehindM = 0.3;
/// A trunk is hidden when its middle is nearer to the shadow's edge than this.
constexpr double kHalfTrunkM = 0.08;

}  // namespace

std::size_t SightField::bin(const Eigen::Vector2d& p_base) {
  const double turn = std::atan2(p_base.y(), p_base.x()) / (2.0 * geometry::kPi) + 0.5;
  return std::min(kBins - 1, static_cast<std::size_t>(turn * static_cast<double>(kBins)));
}

void SightField::learn(const std::vector<Sighting>& sightings) {
  for (const Sighting& s : sightings) {
    int& seen = num_seen_[bin(s.p_base)];
    seen = std::min(seen + 1, kSureSightings);
    farthest_m_ = std::max(farthest_m_, s.p_base.norm());
  }
}

bool SightField::covers(const Eigen::Vector2d& p_base) const {
  return p_base.norm() < range_m() && num_seen_[bin(p_base)] >= kSureSightings;
}

double SightField::range_m() const { return std::min(sure_range_m_, kSureFraction * farthest_m_); }

Shadows::Shadows(const std::vector<Sighting>& sightings) {
  for (const Sighting& s : sightings) {
    const double range_m = s.p_base.norm();
    if (range_m < 1e-3) continue;
    shadows_.push_back({s.p_base / range_m, range_m, 0.5 * s.width_m + kHalfTrunkM});
  }
}

bool Shadows::hide(const Eigen::Vector2d& p_base) const {
  for (const Shadow& shadow : shadows_) {
    const double along_m = shadow.direction.dot(p_base);
    if (along_m < shadow.range_m + kBehindM) continue;
    const double across_m =
        std::abs(shadow.direction.x() * p_base.y() - shadow.direction.y() * p_base.x());
    if (across_m < shadow.half_width_m * along_m / shadow.range_m + kHalfTrunkM) return true;
  }
  return false;
}

}  // namespace orchard::pose
