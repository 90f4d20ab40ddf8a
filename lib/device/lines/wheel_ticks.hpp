// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "device/lines/odometry_driver_config.hpp"
#include "device/lines/sensor_line.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// From what the wheels' counters stand at to velocities of base: the mean over the step between
/// two lines, stamped at its end. A line that was lost costs no distance, since counters go on.
class WheelTicks {
 public:
  /// What a line gave.
  enum class Outcome {
    kMoved,   ///< odometry()
    kFirst,   ///< the first, or the first after more than a second: the next one has a step
    kNoTime,  ///< no later than the one before: refused
    kJumped,  ///< faster than any robot drives: the controller was restarted; begins anew
  };

  explicit WheelTicks(const OdometryDriverConfig& config) : config_(config) {}

  /// `utime`: when the counters stood there [us].
  Outcome add(const TickLine& ticks, std::int64_t utime);

  /// Of the last kMoved; its covariance is unknown.
  const pose::Odometry& odometry() const { return odometry_; }

  /// The clock of `utime` was set by that much [us].
  void shift_time(std::int64_t step_us);

  /// The next line is a first one.
  void restart() { before_.reset(); }

 private:
  struct Stand {
    TickLine ticks;
    std::int64_t utime;
  };
  double moved_m(std::int64_t from, std::int64_t to, double metres_per_tick) const;

  OdometryDriverConfig config_;
  std::optional<Stand> before_;
  pose::Odometry odometry_;
};

}  // namespace orchard::device
