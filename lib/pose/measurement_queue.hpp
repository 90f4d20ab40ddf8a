// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

#include "pose/measurement.hpp"

namespace orchard::pose {

/// How long each kind of measurement is waited for [s of message time], by MeasurementKind; none
/// for a kind that is not expected.
using MeasurementWaits = std::array<std::optional<double>, kNumMeasurementKinds>;

/// Puts the measurements of several kinds into one order of time, whatever the order in which
/// they arrive: a measurement comes out when every expected kind has reached its time, or when any
/// kind is further ahead of it than the missing one is waited for. What arrives after its place in
/// the order has gone out is counted and dropped. Ties come out in the order of the variant's
/// alternatives.
class MeasurementQueue {
 public:
  explicit MeasurementQueue(const MeasurementWaits& waits_s);

  void push(Measurement measurement);

  /// The next one in order that may come out; none when it must wait.
  std::optional<Measurement> pop();

  /// The same at the end of all input: nothing waits any longer.
  std::optional<Measurement> pop_flushed();

  /// Whether a measurement of that time is next, so that equal times can be taken together.
  bool next_is_at(std::int64_t utime) const;

  std::int64_t num_late() const { return num_late_; }

  /// The kind that holds the next measurement back; none if none does.
  std::optional<MeasurementKind> waits_for() const;
  std::optional<std::int64_t> next_utime() const;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();

  std::optional<std::size_t> next_kind() const;
  Measurement take(std::size_t kind);

  std::array<std::optional<std::int64_t>, kNumMeasurementKinds> waits_us_;
  std::array<std::deque<Measurement>, kNumMeasurementKinds> queues_;
  std::array<std::int64_t, kNumMeasurementKinds> newest_utime_;
  std::int64_t released_utime_ = kNever;
  std::int64_t num_late_ = 0;
};

}  // namespace orchard::pose
