// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/driver.hpp"

#include <ctime>
#include <utility>

namespace orchard::bus {
namespace {

/// Smallest clock step that is detected. The two clocks cannot be read at the same instant, because
/// the process may be suspended in between; smaller steps do not matter to a stamp.
constexpr std::int64_t kMinStep_us = 1000;

/// Max number of attempts to read both clocks close together.
constexpr int kNumReadings = 5;

std::int64_t read_clock(clockid_t id) {
  timespec time{};
  clock_gettime(id, &time);
  return std::int64_t{time.tv_sec} * 1000000 + time.tv_nsec / 1000;
}

struct Reading {
  std::int64_t utime = 0;
  std::int64_t offset_us = 0;
};

/// Reads both clocks at nearly one instant: of a few attempts, the fastest one.
Reading read_both() {
  Reading best;
  std::int64_t best_gap_us = -1;
  for (int i = 0; i < kNumReadings; ++i) {
    const std::int64_t before_us = read_clock(CLOCK_MONOTONIC);
    const std::int64_t utime = read_clock(CLOCK_REALTIME);
    const std::int64_t gap_us = read_clock(CLOCK_MONOTONIC) - before_us;
    if (best_gap_us >= 0 && gap_us >= best_gap_us) continue;
    best = {utime, utime - before_us - gap_us / 2};
    best_gap_us = gap_us;
    if (gap_us < kMinStep_us / 10) break;
  }
  return best;
}

}  // namespace

HostClock::HostClock() : offset_us_(read_both().offset_us) {}

std::int64_t HostClock::now() {
  const Reading reading = read_both();
  const std::int64_t step_us = reading.offset_us - offset_us_;
  if (step_us > kMinStep_us || step_us < -kMinStep_us) {
    step_us_ += step_us;
    offset_us_ = reading.offset_us;
  }
  return reading.utime;
}

std::int64_t HostClock::take_step() { return std::exchange(step_us_, 0); }

}  // namespace orchard::bus
