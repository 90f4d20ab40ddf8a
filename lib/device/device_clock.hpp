// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace orchard::device {

/// A device's counter of ticks as the host's time: unwraps it, and ties it to the host without the
/// jitter of lines, networks and schedulers.
///
/// What arrives can be late but never early. So the truth is the line below all (device time,
/// arrival) of the last two minutes, which touches the quickest (Moon, Skelly, Towsley 1999,
/// "Estimation and removal of clock skew"); its slope is the skew of the two clocks. How late the
/// quickest are is learnt from readings of the device's clock (read_between), or given.
class DeviceClock {
 public:
  /// A counter of `num_bits` bits, one per `tick_us`, that starts at 0 when the device does.
  DeviceClock(int num_bits, double tick_us);

  /// A connection was made: from here on nothing of before is still on its way.
  void begin_talk();

  /// The device answered a request with its present ticks: sent and answered at these times [us].
  void read_between(std::uint32_t ticks, std::int64_t asked_utime, std::int64_t answered_utime);

  /// A stamp arrived. Its device time, counted on through wraps [us].
  double arrived(std::uint32_t ticks, std::int64_t host_utime);

  /// The host's time at a device time [us].
  std::int64_t host_utime(double device_us) const;

  /// How long after the stamped instant its bytes arrive at the soonest [us]: of a device whose
  /// clock cannot be read; of another one the least that a reading may say.
  void set_least_delay(double delay_us) { least_delay_us_ = possible_delay_us_ = delay_us; }

  /// The host's clock was set by `step_us`.
  void host_stepped(std::int64_t step_us);

  std::int64_t num_restarts() const { return num_restarts_; }

  /// Host time over device time, minus 1.
  double skew() const { return slope_; }

 private:
  struct Sample {
    double device_us = 0.0;  ///< after device_base_us_
    double delay_us = 0.0;   ///< arrival after host_base_utime_, less device_us
  };
  struct Reading {
    double device_us = 0.0;
    double lo_us = 0.0;  ///< bounds of host time less device time
    double hi_us = 0.0;
  };

  double unwrap(std::uint32_t ticks, std::int64_t host_utime);
  void forget(std::int64_t host_utime, double device_us);
  void keep(const Sample& sample);
  void fit();
  void fit_hull();
  bool is_bent() const;
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
  std::deque<Sample> samples_;  ///< the quickest of each second
  double offset_us_ = 0.0;      ///< the line: delay = offset + slope * device_us
  double slope_ = 0.0;
  double least_delay_us_ = 0.0;
  double possible_delay_us_ = 0.0;
  std::optional<Reading> reading_;  ///< of this talk
  double soonest_us_ = 0.0;         ///< least delay since the reading; infinite before an arrival
  double learn_begin_us_ = 0.0;     ///< of the first arrival since the reading
  std::int64_t num_restarts_ = 0;
};

}  // namespace orchard::device
