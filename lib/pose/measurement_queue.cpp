// SPDX-License-Identifier: BSD-3-Clause
#include "pose/measurement_queue.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace orchard::pose {

MeasurementQueue::MeasurementQueue(const MeasurementWaits& waits_s) {
  for (std::size_t kind = 0; kind < kNumMeasurementKinds; ++kind) {
    if (waits_s[kind]) waits_us_[kind] = std::llround(*waits_s[kind] * 1e6);
  }
  newest_utime_.fill(kNever);
}

void MeasurementQueue::push(Measurement measurement) {
  const std::size_t kind = measurement.index();
  const std::int64_t utime = utime_of(measurement);
  // Equal to the released time is late as well: its pose has been told.
  if (utime <= released_utime_ || utime < newest_utime_[kind]) {
    ++num_late_;
    return;
  }
  newest_utime_[kind] = utime;
  queues_[kind].push_back(std::move(measurement));
}

std::optional<std::size_t> MeasurementQueue::next_kind() const {
  std::optional<std::size_t> next;
  for (std::size_t kind = 0; kind < queues_.size(); ++kind) {
    if (queues_[kind].empty()) continue;
    if (!next || utime_of(queues_[kind].front()) < utime_of(queues_[*next].front())) next = kind;
  }
  return next;
}

Measurement MeasurementQueue::take(std::size_t kind) {
  Measurement measurement = std::move(queues_[kind].front());
  queues_[kind].pop_front();
  released_utime_ = utime_of(measurement);
  return measurement;
}

std::optional<MeasurementKind> MeasurementQueue::waits_for() const {
  const std::optional<std::int64_t> utime = next_utime();
  if (!utime) return std::nullopt;
  const std::int64_t newest_utime = *std::max_element(newest_utime_.begin(), newest_utime_.end());
  for (std::size_t kind = 0; kind < kNumMeasurementKinds; ++kind) {
    if (!waits_us_[kind] || newest_utime_[kind] >= *utime) continue;
    if (newest_utime - *utime <= *waits_us_[kind]) return static_cast<MeasurementKind>(kind);
  }
  return std::nullopt;
}

std::optional<std::int64_t> MeasurementQueue::next_utime() const {
  const std::optional<std::size_t> next = next_kind();
  if (!next) return std::nullopt;
  return utime_of(queues_[*next].front());
}

bool MeasurementQueue::next_is_at(std::int64_t utime) const { return next_utime() == utime; }

std::optional<Measurement> MeasurementQueue::pop() {
  const std::optional<std::size_t> next = next_kind();
  if (!next || waits_for()) return std::nullopt;
  return take(*next);
}

std::optional<Measurement> MeasurementQueue::pop_flushed() {
  const std::optional<std::size_t> next = next_kind();
  if (!next) return std::nullopt;
  return take(*next);
}

}  // namespace orchard::pose
