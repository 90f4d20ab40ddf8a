// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/observation_list.hpp"

#include <Eigen/LU>

namespace orchard::pose {
Eigen::Vector2d SlamObservation::position() const { return information.inverse() * information_m; }

Eigen::Matrix2d SlamObservation::covariance() const {
  return information.inverse() + floor_sd_m * floor_sd_m * Eigen::Matrix2d::Identity();
}

std::vector<SlamObservation>& ObservationList::edit() {
  if (kept_ != nullptr) {
    own_.assign(kept_, kept_ + num_kept_);
    kept_ = nullptr;
  }
  return own_;
}

void ObservationList::keep(ObservationMemory& memory) {
  if (kept_ != nullptr || own_.empty()) return;
  const SlamObservation* const kept = memory.keep(own_);
  if (kept == nullptr) return;
  kept_ = kept;
  num_kept_ = own_.size();
  std::vector<SlamObservation>().swap(own_);  // what is only assigned to keeps its room
}

}  // namespace orchard::pose
