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

/// How a driver is, for STATUS.
struct DriverCondition {
  Level level = Level::kOk;
  std::string text;          ///< what it waits for, what is wrong; empty when all is well
  std::int64_t num_bad = 0;  ///< units that a device sent and that failed a check
};

/// A sensor, or something that plays one: waits for files and a deadline, never blocks, and sends
/// what was measured. LiveDriver owns the loop, so that STATUS, stops and reconnection go on while
/// the sensor is silent.
class Driver {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~Driver() = default;

  /// Files to wait for (poll), asked before each wait: they change with reconnection.
  virtual std::vector<pollfd> files() = 0;

  /// When step() is wanted although no file is ready.
  virtual Clock::time_point deadline() = 0;

  /// A file is ready or the deadline has passed: does what can be done without waiting and sends
  /// what was measured. seq is set by the driver, from 0, +1 per message of a channel.
  virtual void step(const Outbox& send) = 0;

  /// There will be no more.
  virtual bool ended() const { return false; }

  virtual DriverCondition condition() const { return {}; }

  /// How long all messages together last [s], for a progress bar; none when that is not known.
  virtual std::optional<double> duration_s() const { return std::nullopt; }
};

}  // namespace orchard::bus
