// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "device/protocol.hpp"

namespace orchard::simulation {

/// A device that speaks in bytes, seen from its own side of the line: what device::Protocol talks
/// to. Pure: true time [us] is given with every call and never goes back.
class EmulatedDevice {
 public:
  virtual ~EmulatedDevice() = default;

  /// Somebody has connected (a port was opened): earlier bytes of both sides are gone.
  virtual void connected(std::int64_t utime) = 0;

  /// Bytes from the host, in pieces of any size.
  virtual void receive(std::string_view bytes, std::int64_t utime) = 0;

  /// The device has measured this; its utime is the true one. Kinds that it cannot measure are
  /// passed over.
  virtual void measured(const device::Measurement& measurement) = 0;

  /// When advance() has something to do [us]; none: not before something arrives.
  virtual std::optional<std::int64_t> deadline() const = 0;

  /// Sends what is due.
  virtual void advance(std::int64_t utime) = 0;

  /// Bytes for the host, in order; empties them.
  std::string take_to_send() { return std::exchange(to_send_, {}); }

 protected:
  std::string to_send_;
};

/// Of an emulated scanner: from the last beam to the first byte [us].
inline constexpr std::int64_t kSweepProcessing_us = 500;

/// Sweeps that an emulated scanner keeps for a host that is slow to read.
inline constexpr std::size_t kMaxWaitingSweeps = 16;

/// A device's own clock: started at some true time, a little fast or slow.
struct EmulatedClock {
  std::int64_t start_utime = 0;  ///< true time at which it showed 0
  double skew = 0.0;             ///< 100e-6: it gains 100 us in a second

  /// What it shows at a true time, in ticks of `tick_us`, without wrapping.
  std::uint64_t ticks(double utime, double tick_us) const {
    const double shown_us = (utime - static_cast<double>(start_utime)) * (1.0 + skew);
    return shown_us <= 0.0 ? 0 : static_cast<std::uint64_t>(shown_us / tick_us);
  }
};

}  // namespace orchard::simulation
