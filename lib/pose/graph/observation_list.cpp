// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/observation_list.hpp"

#include <Eigen/LU>
#include <memory>

namespace orchard::pose {
namespace {

constexpr std::size_t kRowsPerChunk = ChunkMemory::kChunkBytes / sizeof(SlamObservation);

}  // namespace

Eigen::Vector2d SlamObservation::position() const { return information.inverse() * information_m; }

Eigen::Matrix2d SlamObservation::covariance() const {
  return information.inverse() + floor_sd_m * floor_sd_m * Eigen::Matrix2d::Identity();
}

ObservationMemory::~ObservationMemory() {
  for (SlamObservation* chunk : chunks_) memory_->give_back(chunk);
}

const SlamObservation* ObservationMemory::keep(const std::vector<SlamObservation>& rows) {
  if (rows.size() > kRowsPerChunk) return nullptr;
  if (chunks_.empty() || num_in_last_ + rows.size() > kRowsPerChunk) {
    chunks_.reserve(chunks_.size() + 1);
    chunks_.push_back(static_cast<SlamObservation*>(memory_->take()));
    num_in_last_ = 0;
  }
  SlamObservation* const at = chunks_.back() + num_in_last_;
  std::uninitialized_copy(rows.begin(), rows.end(), at);
  num_in_last_ += rows.size();
  return at;
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
  own_ = {};
}

}  // namespace orchard::pose
