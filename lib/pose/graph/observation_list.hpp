// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pose/graph/row_memory.hpp"

namespace orchard::pose {

/// All observations of one landmark by the scans of one keyframe, summed in information form: its
/// position in base at the keyframe.
struct SlamObservation {
  int landmark = -1;
  int num_scans = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
  double floor_sd_m = 0.0;  ///< systematic error, the same in all scans of a keyframe

  Eigen::Vector2d position() const;
  Eigen::Matrix2d covariance() const;
};

/// Where the observations of keyframes lie that the robot has left.
using ObservationMemory = RowMemory<SlamObservation>;

/// The observations of a keyframe. Kept ones are only read: copies of the list share them, and the
/// first change of a list takes its own copy back to the heap.
class ObservationList {
 public:
  const SlamObservation* begin() const { return kept_ != nullptr ? kept_ : own_.data(); }
  const SlamObservation* end() const { return begin() + size(); }
  std::size_t size() const { return kept_ != nullptr ? num_kept_ : own_.size(); }
  bool empty() const { return size() == 0; }
  const SlamObservation& operator[](std::size_t i) const { return begin()[i]; }

  /// The list, to be changed.
  std::vector<SlamObservation>& edit();

  /// Lets it lie in `memory`, which must outlive it and its copies.
  void keep(ObservationMemory& memory);

 private:
  std::vector<SlamObservation> own_;
  const SlamObservation* kept_ = nullptr;
  std::size_t num_kept_ = 0;
};

}  // namespace orchard::pose
