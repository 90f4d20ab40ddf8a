// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/wheel_ticks.hpp"

#include <cmath>
#include <utility>

namespace orchard::device {
namespace {

constexpr std::int64_t kLongestStep_us = 1'000'000;
constexpr double kSpeedMax_mps = 30.0;  // a wheel of any robot that drives among trees

}  // namespace

WheelTicks::Outcome WheelTicks::add(const TickLine& ticks, std::int64_t utime) {
  if (before_ && utime <= before_->utime) return Outcome::kNoTime;
  const std::optional<Stand> before = std::exchange(before_, Stand{ticks, utime});
  if (!before || utime - before->utime > kLongestStep_us) return Outcome::kFirst;
  const std::int64_t step_us = utime - before->utime;
  const double step_s = 1e-6 * static_cast<double>(step_us);
  const double left_m = moved_m(before->ticks.left, ticks.left, config_.metres_per_tick[0]);
  const double right_m = moved_m(before->ticks.right, ticks.right, config_.metres_per_tick[1]);
  if (std::abs(left_m) > kSpeedMax_mps * step_s || std::abs(right_m) > kSpeedMax_mps * step_s) {
    return Outcome::kJumped;
  }
  odometry_.utime = utime;
  odometry_.speed_mps = (left_m + right_m) / 2.0 / step_s;
  odometry_.yaw_rate_radps = (right_m - left_m) / config_.wheel_distance_m / step_s;
  return Outcome::kMoved;
}

double WheelTicks::moved_m(std::int64_t from, std::int64_t to, double metres_per_tick) const {
  // Modulo 2^counter_bits, the shorter way round: signed and unsigned counters alike.
  const int unused_bits = 64 - config_.counter_bits;
  const std::uint64_t forward = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  const auto ticks = static_cast<std::int64_t>(forward << unused_bits) >> unused_bits;
  return static_cast<double>(ticks) * metres_per_tick;
}

void WheelTicks::shift_time(std::int64_t step_us) {
  if (before_) before_->utime += step_us;
}

}  // namespace orchard::device
