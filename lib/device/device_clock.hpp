// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace orchard::device {

/// Converts a device's tick counter to host time: unwraps the counter and estimates its offset and
/// skew, free of the jitter of serial lines, networks and schedulers.
///
/// A message can arrive late but never early. Host time is therefore the lower envelope line of all
/// points (device time, arrival) of the last two minutes (Moon, Skelly, Towsley 1999, "Estimation
/// and removal of clock skew"); its slope is the skew of the two clocks. The remaining min delay is
/// learnt from readings of the device's clock (read_between), or set.
class DeviceClock {
 public:
  /// A counter of `num_bits` bits with one tick per `tick_us`, which starts at 0 when the device
  /// does.
  DeviceClock(int num_bits, double tick_us);

  /// A counter of microseconds that starts again at 0 after `period_us`.
  static DeviceClock wrapping_after(double period_us);

  /// A connection was made: no message of an earlier connection can arrive any more.
  void begin_connection();

  /// Adds a reading of the device's clock: request and answer at these host times [us].
  void read_between(std::uint32_t ticks, std::int64_t asked_utime, std::int64_t answered_utime);

  /// Adds a stamp that arrived at this host time. Returns its unwrapped device time [us].
  double arrived(std::uint32_t ticks, std::int64_t host_utime);

  /// Host time of a device time [us].
  std::int64_t host_utime(double device_us) const;

  /// Min delay from the stamped instant to the arrival [us]. For a device whose clock cannot be
  /// read it is the delay; otherwise it is the lower bound of the learnt delay.
  void set_min_delay(double delay_us) { least_delay_us_ = possible_delay_us_ = delay_us; }

  /// The host's clock was set forward by `step_us` (backward where negative).
  void host_stepped(std::int64_t step_us);

  std::int64_t num_restarts() const { return num_restarts_; }

  /// Rate of the host clock relative to the device clock, minus 1.
  double skew() const { return slope_; }

 private:
  struct Sample {
    double device_us = 0.0;  ///< relative to device_base_us_
    double delay_us = 0.0;   ///< arrival relative to host_base_utime_, minus device_us
  };
  struct Reading {
    double device_us = 0.0;
    double lo_us = 0.0;  ///< bounds of host time minus device time
    double hi_us = 0.0;
  };

  double unwrap(std::uint32_t ticks, std::int64_t host_utime);
  void forget(std::int64_t host_utime, double device_us);
  void keep(const Sample& sample);
  void fit();
  void fit_hull();
  bool is_nonlinear() const;
  void learn_least_delay(double x_us, double delay_us);
  double least_recent(double span_us) const;

  double period_us_;
  double tick_us_;
  bool started_ = false;
  bool talk_begins_ = true;
  double last_device_us_ = 0.0;
  std::int64_t last_host_utime_ = 0;
  double device_base_us_ = 0.0;
  std::int64_t host_base_utime_ = 0;
  std::deque<Sample> samples_;  ///< the one with the min delay of each second
  double offset_us_ = 0.0;      ///< the line: delay = offset + slope * device_us
  double slope_ = 0.0;
  double least_delay_us_ = 0.0;
  double possible_delay_us_ = 0.0;
  std::optional<Reading> reading_;  ///< of this connection
  double soonest_us_ = 0.0;         ///< min delay since the reading; infinite before an arrival
  double learn_begin_us_ = 0.0;     ///< device time of the first arrival since the reading
  std::int64_t num_restarts_ = 0;
};

}  // namespace orchard::device
