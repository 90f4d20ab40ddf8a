// SPDX-License-Identifier: BSD-3-Clause
#include "pose/measurement_queue.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

std::int64_t utime_of(const Measurement& measurement) {
  return std::visit([](const auto& m) { return m.utime; }, measurement);
}

}  // namespace

MeasurementQueue::MeasurementQueue(bool expects_odometry, bool expects_fixes, double window_s)
    : expected_{expects_odometry, expects_fixes}, window_us_(std::llround(window_s * 1e6)) {}

void MeasurementQueue::push(const Measurement& measurement) {
  const std::size_t channel = measurement.index();
  const std::int64_t utime = utime_of(measurement);
  // Equal to the released time is late as well: its pose has been told.
  if (utime <= released_utime_ || utime < newest_utime_[channel]) {
    ++num_late_;
    return;
  }
  newest_utime_[channel] = utime;
  queues_[channel].push_back(measurement);
}

std::optional<std::size_t> MeasurementQueue::next_channel() const {
  std::optional<std::size_t> next;
  for (std::size_t channel = 0; channel < queues_.size(); ++channel) {
    if (queues_[channel].empty()) continue;
    if (!next || utime_of(queues_[channel].front()) < utime_of(queues_[*next].front())) {
      next = channel;
    }
  }
  return next;
}

Measurement MeasurementQueue::take(std::size_t channel) {
  Measurement measurement = queues_[channel].front();
  queues_[channel].pop_front();
  released_utime_ = utime_of(measurement);
  return measurement;
}

std::optional<std::size_t> MeasurementQueue::waits_for() const {
  const std::optional<std::size_t> next = next_channel();
  if (!next) return std::nullopt;
  const std::int64_t utime = utime_of(queues_[*next].front());
  if (*std::max_element(newest_utime_.begin(), newest_utime_.end()) > utime + window_us_) {
    return std::nullopt;
  }
  for (std::size_t channel = 0; channel < expected_.size(); ++channel) {
    if (expected_[channel] && newest_utime_[channel] < utime) return channel;
  }
  return std::nullopt;
}

std::optional<std::int64_t> MeasurementQueue::next_utime() const {
  const std::optional<std::size_t> next = next_channel();
  if (!next) return std::nullopt;
  return utime_of(queues_[*next].front());
}

bool MeasurementQueue::next_is_at(std::int64_t utime) const { return next_utime() == utime; }

std::optional<Measurement> MeasurementQueue::pop() {
  const std::optional<std::size_t> next = next_channel();
  if (!next || waits_for()) return std::nullopt;
  return take(*next);
}

std::optional<Measurement> MeasurementQueue::pop_flushed() {
  const std::optional<std::size_t> next = next_channel();
  if (!next) return std::nullopt;
  return take(*next);
}

}  // namespace orchard::pose
