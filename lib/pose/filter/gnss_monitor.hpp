// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "pose/measurements.hpp"

namespace orchard::pose {

/// Detects undeclared faults of a receiver from the motion between its fixes: repeated identical
/// fixes (frozen), and more scatter than claimed.
class GnssMonitor {
 public:
  /// Adds a fix and the travel since the last one [m]. Returns true if the receiver is frozen: it
  /// has repeated the same position exactly over more than kFreezeTravel_m.
  bool is_frozen_at(const Gnss& gnss, double travel_m);

  /// Adds the difference between the step of two fixes and the motion between them [m].
  void add_step_error(const Eigen::Vector2d& error_m);

  /// Returns the standard deviation of fixes per axis [m], estimated from the median of the last
  /// steps, so that a jump does not count. None before there are enough steps.
  std::optional<double> scatter_m() const;

 private:
  static constexpr std::size_t kNumSteps = 31;

  std::optional<Gnss> first_same_;          ///< first of the latest identical fixes
  double travel_m_ = 0.0;                   ///< travel since first_same_
  std::array<double, kNumSteps> steps2_{};  ///< squared errors of the last steps [m2]
  std::size_t num_steps_ = 0;
};

}  // namespace orchard::pose
