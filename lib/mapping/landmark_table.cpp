// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/landmark_table.hpp"

#include <limits>
#include <stdexcept>
#include <utility>

namespace orchard::mapping {

LandmarkTable::LandmarkTable(std::vector<LandmarkRecord> records) : records_(std::move(records)) {
  for (std::int32_t index = 0; index < num_indices(); ++index) {
    const LandmarkRecord& r = (*this)[index];
    if (r.is_removed) continue;
    grid_.insert(index, r.association_x_m, r.association_y_m);
    ++num_alive_;
  }
}

std::int32_t LandmarkTable::add(const Eigen::Vector2d& p_map, double width_m) {
  if (records_.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() - 1)) {
    throw std::length_error("mapper: more landmarks than ids");
  }
  const std::int32_t index = num_indices();
  LandmarkRecord r;
  r.association_x_m = p_map.x();
  r.association_y_m = p_map.y();
  r.width_m = static_cast<float>(width_m);
  // Grow by a quarter: doubling could leave half of a large map's memory unused.
  if (records_.size() == records_.capacity()) {
    records_.reserve(records_.size() + records_.size() / 4 + 64);
  }
  records_.push_back(r);
  grid_.insert(index, r.association_x_m, r.association_y_m);
  ++num_alive_;
  return index;
}

void LandmarkTable::remove(std::int32_t index) {
  LandmarkRecord& r = records_[static_cast<std::size_t>(index)];
  grid_.remove(index, r.association_x_m, r.association_y_m);
  r = LandmarkRecord{};
  r.is_removed = true;
  --num_alive_;
}

std::size_t LandmarkTable::num_bytes() const {
  return records_.capacity() * sizeof(LandmarkRecord) + grid_.num_bytes();
}

}  // namespace orchard::mapping
