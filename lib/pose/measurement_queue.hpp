// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <variant>

#include "pose/measurements.hpp"

namespace orchard::pose {

using Measurement = std::variant<Odometry, PoseFix>;

/// Puts the measurements of several channels into one order of time, whatever the order in which
/// they arrive: a measurement comes out when every expected channel has reached its time, or when
/// any channel is more than the window ahead of it. What arrives after its place in the order has
/// gone out is counted and dropped. Ties come out in the order of the variant's alternatives.
class MeasurementQueue {
 public:
  MeasurementQueue(bool expects_odometry, bool expects_fixes, double window_s);

  void push(const Measurement& measurement);

  /// The next one in order that may come out; none when it must wait.
  std::optional<Measurement> pop();

  /// The same at the end of all input: nothing waits any longer.
  std::optional<Measurement> pop_flushed();

  /// Whether a measurement of that time is next, so that equal times can be taken together.
  bool next_is_at(std::int64_t utime) const;

  std::int64_t num_late() const { return num_late_; }

  /// Index (of the variant) of the channel that holds the next measurement back; none if none.
  std::optional<std::size_t> waits_for() const;
  std::optional<std::int64_t> next_utime() const;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();

  std::optional<std::size_t> next_channel() const;
  Measurement take(std::size_t channel);

  std::array<bool, 2> expected_;
  std::int64_t window_us_;
  std::array<std::deque<Measurement>, 2> queues_;
  std::array<std::int64_t, 2> newest_utime_{kNever, kNever};
  std::int64_t released_utime_ = kNever;
  std::int64_t num_late_ = 0;
};

}  // namespace orchard::pose
