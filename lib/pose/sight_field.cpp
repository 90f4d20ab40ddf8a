// SPDX-License-Identifier: BSD-3-Clause
#include "pose/sight_field.hpp"

#include <algorithm>

namespace orchard::pose {

void SightField::learn(const std::vector<Sighting>& sightings) {
  for (const Sighting& s : sightings) {
    int& seen = num_seen_[geometry::sector_of(s.p_base, kBins)];
    seen = std::min(seen + 1, kSureSightings);
    farthest_m_ = std::max(farthest_m_, s.p_base.norm());
  }
}

bool SightField::covers(const Eigen::Vector2d& p_base) const {
  return p_base.norm() < range_m() &&
         num_seen_[geometry::sector_of(p_base, kBins)] >= kSureSightings;
}

double SightField::range_m() const { return std::min(sure_range_m_, kSureFraction * farthest_m_); }

geometry::OcclusionTest occlusion_by(const std::vector<Sighting>& sightings) {
  geometry::OcclusionTest occlusion;
  for (const Sighting& s : sightings) occlusion.add(s.p_base, s.width_m);
  return occlusion;
}

}  // namespace orchard::pose
