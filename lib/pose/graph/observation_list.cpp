// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/observation_list.hpp"

#include <Eigen/LU>

namespace orchard::pose {
Eigen::Vector2d SlamObservation::position() const { return information.inverse() * information_m; }

Eigen::Matrix2d SlamObservation::covariance() const {
  return information.inverse() + floor_sd_m * floor_sd_m * Eigen::Matrix2d::Identity();
}

std::vector<SlamObservation>& ObservationList::edit() {
  if (memory_ != nullptr) {
    own_.assign(begin(), end());
    memory_ = nullptr;
  }
  return own_;
}

void ObservationList::keep(SlamObservationStore& memory) {
  if (memory_ != nullptr || own_.empty()) return;
  kept_ = memory.keep(own_);
  if (kept_.first == nullptr) return;
  memory_ = &memory;
  std::vector<SlamObservation>().swap(own_);  // what is only assigned to keeps its room
}

}  // namespace orchard::pose
