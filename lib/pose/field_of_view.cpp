// SPDX-License-Identifier: BSD-3-Clause
#include "pose/field_of_view.hpp"

#include <algorithm>

namespace orchard::pose {

void FieldOfView::learn(const std::vector<ScanObservation>& observations) {
  for (const ScanObservation& s : observations) {
    int& seen = num_seen_[geometry::sector_of(s.p_base, kBins)];
    seen = std::min(seen + 1, kObservationsMin);
    farthest_m_ = std::max(farthest_m_, s.p_base.norm());
  }
}

bool FieldOfView::covers(const Eigen::Vector2d& p_base) const {
  return p_base.norm() < range_m() &&
         num_seen_[geometry::sector_of(p_base, kBins)] >= kObservationsMin;
}

double FieldOfView::range_m() const {
  return std::min(sure_range_m_, kFieldOfViewFraction * farthest_m_);
}

geometry::OcclusionTest occlusion_by(const std::vector<ScanObservation>& observations) {
  geometry::OcclusionTest occlusion;
  for (const ScanObservation& s : observations) occlusion.add(s.p_base, s.width_m);
  return occlusion;
}

}  // namespace orchard::pose
