// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <unordered_map>

namespace orchard::pose {

/// Position of a landmark in map by several observations, in information form.
struct PositionSum {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
};

/// Cache of the sums of landmarks' observations by keyframes before the window: no scan changes
/// these keyframes any more, only a solve of the whole graph, after which the cache is emptied.
class OlderSums {
 public:
  struct Sum : PositionSum {
    std::size_t num_keyframes = 0;  ///< that are in the sum: the first of SlamLandmark::keyframes
  };

  /// Sets the first keyframe of the window. One before the last value empties the cache.
  void start(int first) {
    if (first < first_) forget();
    first_ = first;
  }

  /// First keyframe that belongs to no sum.
  int first() const { return first_; }

  /// Returns the sum of a landmark, to be extended by its keyframes before first().
  Sum& of(int landmark) {
    if (sums_.size() >= kSumsMax) sums_.clear();
    return sums_[landmark];
  }

  void forget() { sums_.clear(); }
  void forget(int landmark) { sums_.erase(landmark); }

 private:
  /// More than are in the local map; memory must not grow with the drive.
  static constexpr std::size_t kSumsMax = 1024;

  int first_ = 0;
  std::unordered_map<int, Sum> sums_;
};

}  // namespace orchard::pose
