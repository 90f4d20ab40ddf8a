// SPDX-License-Identifier: BSD-3-Clause
// The tie of a device's clock to the host's, against simulated clocks, lines and schedulers.
#include "device/device_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace orchard::device {
namespace {

constexpr std::int64_t kNoon = 1'700'000'000'000'000;

/// A device whose counter of milliseconds starts at `start` and gains `skew`.
struct Device {
  double start_us = 0.0;
  double skew = 0.0;
  std::uint32_t ticks(double utime) const {
    const double shown_us = (utime - start_us) * (1.0 + skew);
    return static_cast<std::uint32_t>(std::fmod(shown_us / 1000.0, 16777216.0));
  }
};

/// A line that needs 3 ms, and a busy host that comes to reading later, now and then much later.
class Line {
 public:
  explicit Line(unsigned seed) : random_(seed) {}
  double delay_us() {
    const double load_us = std::exponential_distribution<double>(1.0 / 4000.0)(random_);
    const bool is_held_up = std::bernoulli_distribution(0.03)(random_);
    return 3000.0 + load_us + (is_held_up ? 60'000.0 : 0.0);
  }

 private:
  std::mt19937 random_;
};

struct Errors {
  double mean_us = 0.0;
  double sd_us = 0.0;
  double worst_us = 0.0;
};

Errors errors_of(const std::vector<double>& errors_us) {
  Errors e;
  for (const double error : errors_us) e.mean_us += error / static_cast<double>(errors_us.size());
  for (const double error : errors_us) {
    e.sd_us += std::pow(error - e.mean_us, 2) / static_cast<double>(errors_us.size());
    e.worst_us = std::max(e.worst_us, std::abs(error));
  }
  e.sd_us = std::sqrt(e.sd_us);
  return e;
}

/// Reads the clock a dozen times, as a request that comes back after about a millisecond.
double read_clock(DeviceClock& clock, const Device& device, double utime, std::mt19937& random) {
  std::uniform_real_distribution<double> way(200.0, 900.0);
  for (int i = 0; i < 12; ++i) {
    const double asked = utime;
    const double shown = asked + way(random);
    utime = shown + way(random);
    clock.read_between(device.ticks(shown), static_cast<std::int64_t>(asked),
                       static_cast<std::int64_t>(utime));
  }
  return utime;
}

/// Stamps of `hours` at 10 Hz against the truth, each sent 75 ms after the stamped instant.
Errors run(Device device, double hours, unsigned seed) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(75e3);
  clock.begin_connection();
  std::mt19937 random(seed);
  Line line(seed);
  double begin = read_clock(clock, device, static_cast<double>(kNoon), random);
  std::vector<double> errors_us;
  for (double t = begin; t < static_cast<double>(kNoon) + hours * 3600e6; t += 100'003.7) {
    const double arrival = t + 75e3 + line.delay_us();
    const double device_us =
        clock.arrived(device.ticks(t), static_cast<std::int64_t>(std::llround(arrival)));
    errors_us.push_back(static_cast<double>(clock.host_utime(device_us)) - t);
  }
  EXPECT_EQ(clock.num_restarts(), 0);
  return errors_of(errors_us);
}

// 24 bits of milliseconds wrap after 4 h 39 min 37 s: this device does two minutes after the start.
TEST(DeviceClock, StampsUnderLoadAndThroughAWrapAreWithinTwoMilliseconds) {
  const double wrap_us = 16777216e3;
  for (const double skew : {0.0, 80e-6, -150e-6}) {
    const Device device{static_cast<double>(kNoon) - wrap_us + 120e6, skew};
    const Errors e = run(device, 0.2, 7);
    EXPECT_LT(e.sd_us, 600.0) << skew;
    EXPECT_LT(std::abs(e.mean_us), 600.0) << skew;
    EXPECT_LT(e.worst_us, 3000.0) << skew;
  }
}

TEST(DeviceClock, TheSkewOfTheClocksIsFound) {
  DeviceClock clock(24, 1000.0);
  const Device device{static_cast<double>(kNoon) - 5e6, 100e-6};
  Line line(3);
  for (double t = static_cast<double>(kNoon); t < static_cast<double>(kNoon) + 120e6; t += 25e3) {
    clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + line.delay_us()));
  }
  EXPECT_NEAR(clock.skew(), -100e-6, 20e-6);
}

// A motor that has to start lets the first sweep come five seconds after the clock was read.
TEST(DeviceClock, TheFirstStampMayComeLongAfterTheClockWasRead) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(20e3);
  const Device device{static_cast<double>(kNoon) - 3600e6, 50e-6};
  std::mt19937 random(1);
  const double read = read_clock(clock, device, static_cast<double>(kNoon), random);
  for (double t = read + 5e6; t < read + 60e6; t += 25e3) {
    const double device_us = clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + 28e3));
    EXPECT_NEAR(static_cast<double>(clock.host_utime(device_us)), t, 1500.0);
  }
}

TEST(DeviceClock, ADeviceThatStartsAnewIsNoticedAndFollowed) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(3000.0);
  Device device{static_cast<double>(kNoon) - 3600e6, 0.0};
  double t = static_cast<double>(kNoon);
  for (; t < static_cast<double>(kNoon) + 60e6; t += 25e3) {
    clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + 3000));
  }
  device.start_us = t;  // the cable was pulled; two seconds later it has booted
  clock.begin_connection();
  for (t += 2e6; t < static_cast<double>(kNoon) + 90e6; t += 25e3) {
    const double device_us = clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + 3000));
    EXPECT_NEAR(static_cast<double>(clock.host_utime(device_us)), t, 1500.0);
  }
  EXPECT_EQ(clock.num_restarts(), 1);
}

TEST(DeviceClock, AHostThatStoodStillReadsLateAndStampsRight) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(3000.0);
  const Device device{static_cast<double>(kNoon) - 3600e6, 0.0};
  const auto start = static_cast<double>(kNoon);
  for (double t = start; t < start + 60e6; t += 25e3) {
    // From 30 s to 40 s the process is stopped: what came meanwhile is read at its end.
    const double second = (t - start) / 1e6;
    const double arrival = second > 30 && second < 40 ? start + 40e6 : t + 3000;
    const double device_us =
        clock.arrived(device.ticks(t), static_cast<std::int64_t>(std::max(arrival, t + 3000)));
    EXPECT_NEAR(static_cast<double>(clock.host_utime(device_us)), t, 1500.0) << second;
  }
  EXPECT_EQ(clock.num_restarts(), 0);
}

TEST(DeviceClock, AStepOfTheHostsClockMovesTheStampsAtOnce) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(3000.0);
  const Device device{static_cast<double>(kNoon) - 3600e6, 0.0};
  const auto start = static_cast<double>(kNoon);
  double step_us = 0.0;
  for (double t = start; t < start + 60e6; t += 25e3) {
    if (step_us == 0.0 && t > start + 30e6) {
      step_us = -3600e6;
      clock.host_stepped(-3'600'000'000);
    }
    const double device_us =
        clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + step_us + 3000));
    EXPECT_NEAR(static_cast<double>(clock.host_utime(device_us)), t + step_us, 1500.0);
  }
  EXPECT_EQ(clock.num_restarts(), 0);
}

// NTP that pulls the host's clock by 500 ppm for a minute: 30 ms in all.
TEST(DeviceClock, AHostThatIsSlewedIsFollowed) {
  DeviceClock clock(24, 1000.0);
  clock.set_min_delay(3000.0);
  const Device device{static_cast<double>(kNoon) - 3600e6, 0.0};
  const auto start = static_cast<double>(kNoon);
  double worst_us = 0.0;
  for (double t = start; t < start + 400e6; t += 25e3) {
    const double slewed_us = 500e-6 * std::clamp(t - start - 150e6, 0.0, 60e6);
    const double device_us =
        clock.arrived(device.ticks(t), static_cast<std::int64_t>(t + slewed_us + 3000));
    const double error_us = static_cast<double>(clock.host_utime(device_us)) - t - slewed_us;
    worst_us = std::max(worst_us, std::abs(error_us));
  }
  EXPECT_LT(worst_us, 5000.0);
}

TEST(DeviceClock, ACounterOf32BitsOfMicrosecondsWrapsToo) {
  DeviceClock clock(32, 1.0);
  const auto start = static_cast<double>(kNoon);
  const double started = start - 4294967296.0 + 20e6;  // wraps after 20 s
  for (double t = start; t < start + 60e6; t += 66'667.0) {
    const auto ticks = static_cast<std::uint32_t>(std::fmod(t - started, 4294967296.0));
    const double device_us = clock.arrived(ticks, static_cast<std::int64_t>(t));
    EXPECT_NEAR(static_cast<double>(clock.host_utime(device_us)), t, 3.0);
  }
  EXPECT_EQ(clock.num_restarts(), 0);
}

}  // namespace
}  // namespace orchard::device
