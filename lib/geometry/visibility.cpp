// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/visibility.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::geometry {
namespace {

/// physical: min distance behind a seen trunk: a nearer point is the trunk itself.
constexpr double kBehind_m = 0.3;
/// physical: half a trunk; border of the shadow: a trunk counts as hidden up to this far beside
/// it.
constexpr double kHalfTrunk_m = 0.08;

}  // namespace

Outline outline_of(const Eigen::Vector2d& centre, double radius_m) {
  const double distance_m = centre.norm();
  return {distance_m, std::atan2(centre.y(), centre.x()),
          std::asin(std::min(1.0, radius_m / std::max(distance_m, 1e-9)))};
}

std::size_t sector_of(const Eigen::Vector2d& p, std::size_t num) {
  const double turn = std::atan2(p.y(), p.x()) / (2.0 * kPi) + 0.5;
  return std::min(num - 1, static_cast<std::size_t>(turn * static_cast<double>(num)));
}

void OcclusionTest::add(const Eigen::Vector2d& p, double width_m) {
  const double range_m = p.norm();
  if (range_m < 1e-3) return;
  shadows_.push_back({p / range_m, range_m, 0.5 * width_m + kHalfTrunk_m});
}

bool OcclusionTest::occludes(const Eigen::Vector2d& p) const {
  for (const Shadow& shadow : shadows_) {
    const double along_m = shadow.direction.dot(p);
    if (along_m < shadow.range_m + kBehind_m) continue;
    const double across_m = std::abs(shadow.direction.x() * p.y() - shadow.direction.y() * p.x());
    if (across_m < shadow.half_width_m * along_m / shadow.range_m + kHalfTrunk_m) return true;
  }
  return false;
}

}  // namespace orchard::geometry
