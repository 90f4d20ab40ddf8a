// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pose/graph/record_store.hpp"

namespace orchard::pose {

/// Sum of all observations of one landmark by the scans of one keyframe: its position in base at
/// the keyframe, in information form.
struct SlamObservation {
  int landmark = -1;
  int num_scans = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
  double floor_sd_m = 0.0;  ///< systematic error, common to all scans of a keyframe

  Eigen::Vector2d position() const;
  Eigen::Matrix2d covariance() const;
};

/// Storage of the observations of older keyframes.
using SlamObservationStore = RecordStore<SlamObservation>;

/// Observations of a keyframe, copy-on-write: after keep(), copies of the list share the stored
/// rows, and edit() makes an own copy on the heap.
class ObservationList {
 public:
  const SlamObservation* begin() const {
    if (memory_ == nullptr) return own_.data();
    memory_->use(kept_);
    return kept_.first;
  }
  const SlamObservation* end() const { return begin() + size(); }
  std::size_t size() const { return memory_ != nullptr ? kept_.num_rows : own_.size(); }
  bool empty() const { return size() == 0; }
  const SlamObservation& operator[](std::size_t i) const { return begin()[i]; }

  /// Returns the list for modification.
  std::vector<SlamObservation>& edit();

  /// Moves the rows to `memory`, which must outlive this list and its copies.
  void keep(SlamObservationStore& memory);

 private:
  std::vector<SlamObservation> own_;
  const SlamObservationStore* memory_ = nullptr;  ///< that stores the rows; null: own_
  SlamObservationStore::Place kept_;
};

}  // namespace orchard::pose
