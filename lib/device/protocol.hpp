// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "device/unit_counter.hpp"
#include "laser/scan.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// A measurement of a device with a byte protocol. Protocols leave seq 0; the driver sets it.
using Measurement = std::variant<laser::Scan, pose::Odometry, pose::Imu, pose::Gnss>;

/// How serious a condition is; the values are those of STATUS.
enum class Severity : std::int8_t { kNone = 0, kWaiting = 1, kWarning = 2, kError = 3 };

/// What a device waits for, or what is wrong with it.
struct Condition {
  Severity severity = Severity::kNone;
  std::string text;  ///< for the user; with kNone what is worth knowing, or empty

  /// Adds what is also the case, after a semicolon.
  void add(Severity more_severity, const std::string& more) {
    if (more.empty()) return;
    severity = std::max(severity, more_severity);
    text += (text.empty() ? "" : "; ") + more;
  }
};

/// Protocol of one device: bytes in, bytes out, measurements.
///
/// It uses no file, no socket and no clock. Every call gets host_utime [us], the time at which the
/// bytes could be read, which never goes back within a connection. The same object therefore serves
/// a live device, a recording of raw bytes and the tests.
class Protocol {
 public:
  virtual ~Protocol() = default;

  /// A new connection was made: forgets partly read bytes and begins the dialogue.
  virtual void connected(std::int64_t host_utime) = 0;

  /// Bytes arrived; they may be split at any position. By UDP, a datagram.
  virtual void receive(std::string_view bytes, std::int64_t host_utime) = 0;

  /// Time at which to call expire() if nothing arrives before [us]; none: never.
  virtual std::optional<std::int64_t> deadline() const = 0;

  /// The deadline has passed: repeats the request, or sets failure().
  virtual void expire(std::int64_t host_utime) = 0;

  /// The host's clock was set: add `step_us` to every earlier host_utime.
  virtual void host_clock_stepped(std::int64_t step_us) = 0;

  /// Why the connection must be closed and reopened, as text for the user; empty: no failure.
  virtual std::string failure() const = 0;

  /// What the protocol waits for, or what is wrong; Severity::kNone while measurements arrive.
  virtual Condition condition() const = 0;

  virtual ProtocolCounts counts() const = 0;

  /// Removes and returns the bytes to send to the device, in order.
  std::string take_to_send() { return std::exchange(to_send_, {}); }

  /// Removes and returns the measurements since the last call, in order of time.
  std::vector<Measurement> take_measurements() { return std::exchange(measurements_, {}); }

 protected:
  std::string to_send_;
  std::vector<Measurement> measurements_;
};

}  // namespace orchard::device
