// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "pose/measurements.hpp"

namespace orchard::pose {

/// What a receiver does wrong without saying so, told from the motion between its fixes: it repeats
/// itself (frozen), or it scatters more than it claims.
class GnssMonitor {
 public:
  /// Takes a fix and the travel since the last one [m]. Whether the receiver is frozen: it has
  /// given the same fix to the last digit over more than kFreezeTravel_m.
  bool is_frozen_at(const Gnss& gnss, double travel_m);

  /// Takes how far the step between two fixes was from the motion between them [m].
  void add_step_error(const Eigen::Vector2d& error_m);

  /// Standard deviation per axis [m] that the last steps speak for: from their median, so that a
  /// jump does not count. None before there are enough.
  std::optional<double> scatter_m() const;

 private:
  static constexpr std::size_t kNumSteps = 31;

  std::optional<Gnss> first_same_;          ///< of the fixes that are all the same
  double travel_m_ = 0.0;                   ///< since that one
  std::array<double, kNumSteps> steps2_{};  ///< squared errors of the last steps [m2]
  std::size_t num_steps_ = 0;
};

}  // namespace orchard::pose
