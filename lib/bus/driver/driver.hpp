// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/messages/service_messages.hpp"
#include "bus/node/node.hpp"

namespace orchard::bus {

/// Clock that stamps measurements: the host's time of day (CLOCK_REALTIME), shared by all processes
/// of a host and, when synchronized by NTP or PTP, by all hosts of a robot. Slewing changes its
/// rate by at most 500 ppm. A step is detected by comparison with CLOCK_MONOTONIC, which slews in
/// the same way but never steps.
class HostClock {
 public:
  HostClock();

  /// Now [us since 1970].
  std::int64_t now();

  /// Returns by how much now() has seen the clock set since the last call of take_step() [us].
  std::int64_t take_step();

 private:
  std::int64_t offset_us_;  ///< time of day minus monotonic time
  std::int64_t step_us_ = 0;
};

/// State of a driver, as reported in STATUS.
struct DriverCondition {
  Level level = Level::kOk;
  std::string text;          ///< what it waits for or what is wrong; empty when all is well
  std::int64_t num_bad = 0;  ///< data units of the device that failed a check
};

/// A sensor or an emulation of one. It waits for files and a deadline, never blocks, and sends
/// measurements. LiveDriver runs the loop, so that STATUS, stops and reconnection work while the
/// sensor is silent.
class Driver {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~Driver() = default;

  /// Files to poll; queried before each wait, because they change with reconnection.
  virtual std::vector<pollfd> files() = 0;

  /// Time at which step() must be called even if no file is ready.
  virtual Clock::time_point deadline() = 0;

  /// Called when a file is ready or the deadline has passed: does all work that does not block and
  /// sends the measurements. The driver sets seq, from 0, +1 per message of a channel.
  virtual void step(const Outbox& send) = 0;

  /// Whether no more messages will follow.
  virtual bool ended() const { return false; }

  virtual DriverCondition condition() const { return {}; }

  /// Total duration of the messages [s] for a progress bar; none when unknown.
  virtual std::optional<double> duration_s() const { return std::nullopt; }
};

}  // namespace orchard::bus
