// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "device/device_clock.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// Common base of the scanner protocols. A request without an answer in time is repeated, up to
/// three times in all; after the dialogue the sweeps arrive, and when they stop the dialogue
/// restarts.
class ScannerSession : public Protocol {
 public:
  std::optional<std::int64_t> deadline() const override { return deadline_utime_; }
  void host_clock_stepped(std::int64_t step_us) override;
  std::string failure() const override { return failure_; }
  Condition condition() const override;
  ProtocolCounts counts() const override { return units_.counts(); }

  const DeviceClock& clock() const { return clock_; }

  /// Makes all stamps earlier [s].
  void set_delay(double delay_s) { delay_us_ = std::llround(1e6 * delay_s); }

 protected:
  static constexpr std::int64_t kAnswer_us = 500'000;
  static constexpr int kMaxAsked = 3;
  /// A scanner needs seconds after power-up or while its motor starts.
  static constexpr std::int64_t kFirstSweep_us = 6'000'000;
  /// The longest reply is a sweep with intensities of about 10,000 beams.
  static constexpr std::size_t kMaxReply = 128 * 1024;

  /// Width and tick length of the scanner's clock.
  ScannerSession(int clock_bits, double tick_us) : clock_(clock_bits, tick_us) {}
  explicit ScannerSession(DeviceClock clock) : clock_(std::move(clock)) {}

  /// Forgets the state of an earlier connection; call from connected().
  void reset_session();

  /// Sends the current command; `framed` is its form on the wire.
  void send(const std::string& framed, std::int64_t host_utime);
  void fail(const std::string& why);

  /// Drops the buffer when it exceeds kMaxReply: the reply has no end.
  void bound_buffer(std::int64_t host_utime);

  /// Handles missing sweeps. True: restart the dialogue; false: the connection has failed.
  bool may_restart();

  /// Adds a sweep, whose utime is set. Rejects it unless its utime is after that of the last sweep:
  /// the counter has jumped.
  void take_scan(laser::Scan scan, std::int64_t host_utime);

  /// What is worth knowing of a scanner that is well.
  virtual std::string note() const { return {}; }

  DeviceClock clock_;
  UnitCounter units_;
  std::string buffer_;
  std::string command_;  ///< of the present step
  std::int64_t asked_utime_ = 0;
  std::optional<std::int64_t> deadline_utime_;
  int num_asked_ = 0;          ///< of the present step
  bool is_streaming_ = false;  ///< a sweep has arrived since the dialogue began
  Condition trouble_;          ///< what the scanner reports of itself

 private:
  std::int64_t delay_us_ = 0;
  std::optional<std::int64_t> last_utime_;
  std::string failure_;
};

}  // namespace orchard::device
