// SPDX-License-Identifier: BSD-3-Clause
#include "device/device_clock.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orchard::device {
namespace {

/// Length of the window. Long enough to contain arrivals without delay on a busy host, short enough
/// for a constant skew.
constexpr double kWindow_us = 120e6;
constexpr double kBucket_us = 1e6;

/// Min span for a fit of the slope: over a shorter one, jitter of milliseconds makes the last slope
/// the better estimate.
constexpr double kMinSpan_us = 20e6;

/// Span of the offset estimate while the slope is unknown.
constexpr double kRecent_us = 5e6;

/// Two crystals differ by 200 ppm at most, and NTP slews a host by up to 500 ppm.
constexpr double kMaxSkew = 1000e-6;

/// Min delay of the last kRecent_us above the line that shows a change of the rate.
constexpr double kBend_us = 1500.0;

/// A stamp this far from its expected time shows that the counter was reset.
constexpr double kRestart_us = 1e6;

/// Time after the first arrival in which the min delay is learnt from single arrivals; over a
/// longer time, unknown skew falsifies it. From the line it is learnt while the line begins near
/// the reading.
constexpr double kLearn_us = 3e6;
constexpr double kLearnByLine_us = 100e6;

}  // namespace

DeviceClock::DeviceClock(int num_bits, double tick_us)
    : period_us_(std::ldexp(tick_us, num_bits)), tick_us_(tick_us) {}

DeviceClock DeviceClock::wrapping_after(double period_us) {
  DeviceClock clock(32, 1.0);
  clock.period_us_ = period_us;
  return clock;
}

void DeviceClock::begin_connection() {
  talk_begins_ = true;
  reading_.reset();
}

void DeviceClock::forget(std::int64_t host_utime, double device_us) {
  samples_.clear();
  reading_.reset();
  device_base_us_ = device_us;
  host_base_utime_ = host_utime;
  offset_us_ = 0.0;
}

double DeviceClock::unwrap(std::uint32_t ticks, std::int64_t host_utime) {
  const double raw_us = tick_us_ * ticks;
  if (!started_) {
    started_ = true;
    forget(host_utime, raw_us);
    last_device_us_ = raw_us;
    last_host_utime_ = host_utime;
    talk_begins_ = false;
    return raw_us;
  }
  const double gap_us = static_cast<double>(host_utime - last_host_utime_);
  const double expected_us = last_device_us_ + gap_us;
  double device_us = raw_us + period_us_ * std::round((expected_us - raw_us) / period_us_);
  const double tolerance_us = kRestart_us + kMaxSkew * std::abs(gap_us);
  // Within a connection, a delayed host reads old stamps late; they must only not go backwards.
  const bool is_late = talk_begins_ ? device_us < expected_us - tolerance_us
                                    : device_us < last_device_us_ - kRestart_us;
  if (is_late || device_us > expected_us + tolerance_us) {
    ++num_restarts_;
    device_us = raw_us;
    forget(host_utime, device_us);
  }
  talk_begins_ = false;
  last_device_us_ = device_us;
  last_host_utime_ = host_utime;
  return device_us;
}

void DeviceClock::read_between(std::uint32_t ticks, std::int64_t asked_utime,
                               std::int64_t answered_utime) {
  const double device_us = unwrap(ticks, answered_utime) - device_base_us_;
  const double answered_us = static_cast<double>(answered_utime - host_base_utime_);
  const double asked_us = static_cast<double>(asked_utime - host_base_utime_);
  // The counter showed `ticks` for one tick at some time between request and answer.
  Reading now{device_us, asked_us - device_us - tick_us_, answered_us - device_us};
  if (reading_) {
    const double lo_us = std::max(reading_->lo_us, now.lo_us);
    const double hi_us = std::min(reading_->hi_us, now.hi_us);
    if (lo_us <= hi_us) now = {device_us, lo_us, hi_us};
  } else {
    samples_.clear();  // a new connection has another delay
  }
  reading_ = now;
  soonest_us_ = HUGE_VAL;
  offset_us_ = 0.5 * (now.lo_us + now.hi_us) + least_delay_us_ - slope_ * device_us;
}

double DeviceClock::arrived(std::uint32_t ticks, std::int64_t host_utime) {
  const double device_us = unwrap(ticks, host_utime);
  const double x_us = device_us - device_base_us_;
  const double delay_us = static_cast<double>(host_utime - host_base_utime_) - x_us;
  keep({x_us, delay_us});
  fit();
  if (reading_) learn_least_delay(x_us, delay_us);
  return device_us;
}

void DeviceClock::learn_least_delay(double x_us, double delay_us) {
  const double read_us = 0.5 * (reading_->lo_us + reading_->hi_us);
  const double since_us = x_us - reading_->device_us;
  // Count from the first arrival, which may be seconds after the reading while a motor starts.
  if (!std::isfinite(soonest_us_)) learn_begin_us_ = x_us;
  if (x_us - learn_begin_us_ < kLearn_us) soonest_us_ = std::min(soonest_us_, delay_us);
  double soonest_us = soonest_us_;
  const double line_begins_us = samples_.front().device_us - learn_begin_us_;
  const double line_us = samples_.back().device_us - samples_.front().device_us;
  if (line_us >= kMinSpan_us) {
    if (since_us > kLearnByLine_us || line_begins_us > kLearn_us) return;
    soonest_us = offset_us_ + slope_ * reading_->device_us;
  }
  least_delay_us_ = std::max(possible_delay_us_, soonest_us - read_us);
}

void DeviceClock::keep(const Sample& sample) {
  const bool same_second =
      !samples_.empty() && std::floor(samples_.back().device_us / kBucket_us) ==
                               std::floor(sample.device_us / kBucket_us);
  if (!same_second) {
    samples_.push_back(sample);
  } else if (sample.delay_us < samples_.back().delay_us) {
    samples_.back() = sample;
  }
  while (sample.device_us - samples_.front().device_us > kWindow_us) samples_.pop_front();
}

double DeviceClock::least_recent(double span_us) const {
  double least_us = HUGE_VAL;
  const double from_us = samples_.back().device_us - span_us;
  for (auto s = samples_.rbegin(); s != samples_.rend() && s->device_us >= from_us; ++s) {
    least_us = std::min(least_us, s->delay_us - slope_ * s->device_us);
  }
  return least_us;
}

void DeviceClock::fit() {
  while (samples_.back().device_us - samples_.front().device_us >= kMinSpan_us) {
    fit_hull();
    if (!is_nonlinear()) return;
    // The rate of one clock has changed (for example NTP slews the host): drop the older half.
    samples_.erase(samples_.begin(),
                   samples_.begin() + static_cast<std::ptrdiff_t>((samples_.size() + 1) / 2));
  }
  offset_us_ = least_recent(kRecent_us);
}

bool DeviceClock::is_nonlinear() const {
  const Sample& last = samples_.back();
  auto first = samples_.rbegin();
  while (first != samples_.rend() && last.device_us - first->device_us < kRecent_us) ++first;
  --first;
  // A burst of messages read after the host stood still says nothing about the clocks.
  const double arrived_over_us =
      last.device_us + last.delay_us - first->device_us - first->delay_us;
  return arrived_over_us > 0.5 * kRecent_us && least_recent(kRecent_us) - offset_us_ > kBend_us;
}

/// Fits the line below all samples that is nearest to them: the edge of their lower hull below the
/// mean time.
void DeviceClock::fit_hull() {
  std::vector<Sample> hull;
  double mean_us = 0.0;
  for (const Sample& c : samples_) {
    mean_us += c.device_us / static_cast<double>(samples_.size());
    while (hull.size() >= 2) {
      const Sample& a = hull[hull.size() - 2];
      const Sample& b = hull.back();
      const double cross = (b.device_us - a.device_us) * (c.delay_us - a.delay_us) -
                           (c.device_us - a.device_us) * (b.delay_us - a.delay_us);
      if (cross > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(c);
  }
  std::size_t i = 1;
  while (i + 1 < hull.size() && hull[i].device_us < mean_us) ++i;
  const double slope =
      (hull[i].delay_us - hull[i - 1].delay_us) / (hull[i].device_us - hull[i - 1].device_us);
  slope_ = std::clamp(slope, -kMaxSkew, kMaxSkew);
  offset_us_ = least_recent(HUGE_VAL);
}

std::int64_t DeviceClock::host_utime(double device_us) const {
  const double x_us = device_us - device_base_us_;
  const double delay_us = offset_us_ + slope_ * x_us - least_delay_us_;
  return host_base_utime_ +
         static_cast<std::int64_t>(std::llround(x_us + delay_us + 0.5 * tick_us_));
}

void DeviceClock::host_stepped(std::int64_t step_us) {
  host_base_utime_ += step_us;
  last_host_utime_ += step_us;
}

}  // namespace orchard::device
