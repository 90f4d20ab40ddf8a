// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "device/protocol.hpp"

namespace orchard::device {

/// An emulated device: the counterpart of device::Protocol. Pure: every call gets the true time
/// [us], which never goes back.
class EmulatedDevice {
 public:
  virtual ~EmulatedDevice() = default;

  /// The host has connected (a port was opened): earlier bytes of both sides are discarded.
  virtual void connected(std::int64_t utime) = 0;

  /// Bytes from the host; they may be split at any position.
  virtual void receive(std::string_view bytes, std::int64_t utime) = 0;

  /// Adds a measurement with its true utime. Kinds that the device cannot measure are ignored.
  virtual void measured(const device::Measurement& measurement) = 0;

  /// Time of the next call of advance() [us]; none: not until bytes or a measurement arrive.
  virtual std::optional<std::int64_t> deadline() const = 0;

  /// Sends the bytes that are due.
  virtual void advance(std::int64_t utime) = 0;

  /// Removes and returns the bytes for the host, in order.
  std::string take_to_send() { return std::exchange(to_send_, {}); }

 protected:
  std::string to_send_;
};

/// Delay of an emulated scanner from the last beam to the first byte [us].
inline constexpr std::int64_t kSweepProcessing_us = 500;

/// Max number of sweeps that an emulated scanner buffers for a slow host.
inline constexpr std::size_t kMaxWaitingSweeps = 16;

/// A device's clock with its start time and a small skew.
struct EmulatedClock {
  std::int64_t start_utime = 0;  ///< true time at which it showed 0
  double skew = 0.0;             ///< 100e-6: it gains 100 us in a second

  /// The clock's reading at a true time, in ticks of `tick_us`, without wrapping.
  std::uint64_t ticks(double utime, double tick_us) const {
    const double shown_us = (utime - static_cast<double>(start_utime)) * (1.0 + skew);
    return shown_us <= 0.0 ? 0 : static_cast<std::uint64_t>(shown_us / tick_us);
  }
};

}  // namespace orchard::device
