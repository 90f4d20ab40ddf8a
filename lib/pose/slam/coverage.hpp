// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::pose {

/// How far the detector sees in each direction of base, learnt from what it reports: what should
/// have been seen again is told from what could not be.
class SlamSightField {
 public:
  /// A sighting of anything.
  void saw(const Eigen::Vector2d& p_base) { farthest_m_ = std::max(farthest_m_, p_base.norm()); }

  /// A sighting of what is known to be there.
  void saw_again(const Eigen::Vector2d& p_base) {
    double& reach_m = reach_m_[bin(p_base)];
    const double range_m = p_base.norm();
    // slowly back to what is common, should one sighting have been far beyond the rest
    reach_m = range_m > reach_m ? range_m : std::max(range_m, 0.999 * reach_m);
  }

  /// Whether an object there is seen for sure when nothing hides it.
  bool in_view(const Eigen::Vector2d& p_base) const {
    const int b = bin(p_base);
    const double reach_m =
        std::min({reach_m_[b], reach_m_[(b + 1) % kBins], reach_m_[(b + kBins - 1) % kBins]});
    return p_base.norm() < kSureFraction * reach_m;
  }

  /// Farthest sighting so far [m].
  double farthest_m() const { return farthest_m_; }

 private:
  static constexpr int kBins = 36;
  static constexpr double kSureFraction = 0.7;

  static int bin(const Eigen::Vector2d& p_base) {
    const double turn = std::atan2(p_base.y(), p_base.x()) / (2.0 * geometry::kPi) + 0.5;
    return std::min(kBins - 1, static_cast<int>(turn * kBins));
  }

  std::array<double, kBins> reach_m_{};
  double farthest_m_ = 0.0;
};

}  // namespace orchard::pose
