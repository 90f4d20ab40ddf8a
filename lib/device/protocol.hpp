// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "laser/scan.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// What a device that speaks in bytes can measure. seq is the driver's: protocols leave it 0.
using Measurement = std::variant<laser::Scan, pose::Odometry, pose::Imu, pose::Gnss>;

/// What arrived from the device since the start, through every connection.
struct ProtocolCounts {
  std::int64_t num_good = 0;  ///< whole, checked units: a sweep, a line, a report
  std::int64_t num_bad = 0;   ///< units refused: checksum, length, number, range
};

/// The talk with one device: bytes in, bytes out, measurements. Pure: knows no file, no socket and
/// no clock; host_utime [us] is given with every call, never goes back within one connection and is
/// the time at which the bytes were there to be read. The same object serves live, from a recording
/// of raw bytes and in tests.
class Protocol {
 public:
  virtual ~Protocol() = default;

  /// A connection was made (again): forgets half-read bytes and begins the talk.
  virtual void connected(std::int64_t host_utime) = 0;

  /// Bytes that arrived, in pieces of any size.
  virtual void receive(std::string_view bytes, std::int64_t host_utime) = 0;

  /// When expire() is to be called if nothing arrives before [us]; none: never.
  virtual std::optional<std::int64_t> deadline() const = 0;

  /// The deadline has passed: asks again, or sets failure().
  virtual void expire(std::int64_t host_utime) = 0;

  /// The host's clock was set: every earlier host_utime is to be read as that plus `step_us`.
  virtual void host_clock_stepped(std::int64_t step_us) = 0;

  /// Why the connection is to be closed and made anew, in words for a person; empty: all is well.
  virtual std::string failure() const = 0;

  /// What it waits for or what is wrong, in words for a person; empty when measurements come.
  virtual std::string condition() const = 0;

  virtual ProtocolCounts counts() const = 0;

  /// Bytes for the device, in order; empties them.
  std::string take_to_send() { return std::exchange(to_send_, {}); }

  /// What was measured since the last call, in order of time; empties it.
  std::vector<Measurement> take_measurements() { return std::exchange(measurements_, {}); }

 protected:
  std::string to_send_;
  std::vector<Measurement> measurements_;
};

}  // namespace orchard::device
