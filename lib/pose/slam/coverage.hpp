// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/visibility.hpp"

namespace orchard::pose {

/// Sensor coverage: the range at which objects are detected, per direction of base, learnt from the
/// detections. It separates landmarks that should have been observed again from those out of view.
class SensorCoverage {
 public:
  /// Adds an observation of any object.
  void add_observation(const Eigen::Vector2d& p_base) {
    range_max_m_ = std::max(range_max_m_, p_base.norm());
  }

  /// Adds an observation of a confirmed landmark.
  void add_reobservation(const Eigen::Vector2d& p_base) {
    double& reach_m = reach_m_[bin(p_base)];
    const double range_m = p_base.norm();
    // Decays to the usual range after a single observation far beyond the rest.
    reach_m = range_m > reach_m ? range_m : std::max(range_m, 0.999 * reach_m);
  }

  /// True if an object at this position is reliably detected unless it is occluded.
  bool in_view(const Eigen::Vector2d& p_base) const {
    const int b = bin(p_base);
    const double reach_m =
        std::min({reach_m_[b], reach_m_[(b + 1) % kBins], reach_m_[(b + kBins - 1) % kBins]});
    return p_base.norm() < kSureFraction * reach_m;
  }

  /// Returns the range of the farthest observation so far [m].
  double range_max_m() const { return range_max_m_; }

 private:
  static constexpr int kBins = 36;
  static constexpr double kSureFraction = 0.7;

  static int bin(const Eigen::Vector2d& p_base) {
    return static_cast<int>(geometry::sector_of(p_base, kBins));
  }

  std::array<double, kBins> reach_m_{};
  double range_max_m_ = 0.0;
};

}  // namespace orchard::pose
