// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/paced_source.hpp"

#include <chrono>

namespace orchard::bus {

void PacedSource::begin() {
  if (begun_) return;
  begun_ = true;
  next_ = source_.next();
  start_ = Clock::now();
  if (next_) first_utime_ = utime_of(*next_);
}

Driver::Clock::time_point PacedSource::deadline() {
  begin();
  if (!next_) return Clock::time_point::max();
  const double due_us = static_cast<double>(utime_of(*next_) - first_utime_) / speed_;
  return start_ + std::chrono::microseconds(static_cast<std::int64_t>(due_us));
}

void PacedSource::step(const Outbox& send) {
  if (deadline() > Clock::now() || !next_) return;
  send(*next_);
  next_ = source_.next();
}

}  // namespace orchard::bus
