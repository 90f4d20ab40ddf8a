// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "device/device_clock.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// What talks with scanners have in common, whatever their make: a question is asked, asked again
/// when no answer comes in time, given up after three times; then sweeps come, and when they stop
/// the talk begins anew.
class ScannerTalk : public Protocol {
 public:
  std::optional<std::int64_t> deadline() const override { return deadline_utime_; }
  void host_clock_stepped(std::int64_t step_us) override;
  std::string failure() const override { return failure_; }
  std::string condition() const override;
  ProtocolCounts counts() const override { return counts_; }

  const DeviceClock& clock() const { return clock_; }

 protected:
  static constexpr std::int64_t kAnswer_us = 500'000;
  static constexpr int kMaxAsked = 3;
  /// A scanner that was just switched on, or whose motor was standing, needs seconds.
  static constexpr std::int64_t kFirstSweep_us = 6'000'000;
  /// The longest reply is a sweep with intensities of some 10,000 beams.
  static constexpr std::size_t kMaxReply = 128 * 1024;

  /// Its clock counts in so many bits, in ticks of this length.
  ScannerTalk(int clock_bits, double tick_us) : clock_(clock_bits, tick_us) {}

  /// Forgets an earlier talk: for connected().
  void forget_talk();

  /// Sends the present command; `framed` is how it goes over the wire.
  void send(const std::string& framed, std::int64_t host_utime);
  void fail(const std::string& why);

  /// A reply without an end is given up.
  void bound_buffer();

  /// No sweep has come for too long. True: the talk is to begin anew; false: it has failed.
  bool may_begin_anew();

  /// A sweep whose utime is set. Two cannot be of one time: of a counter that jumped it is refused.
  void take_scan(laser::Scan scan);

  DeviceClock clock_;
  ProtocolCounts counts_;
  std::string buffer_;
  std::string command_;  ///< of the present step
  std::int64_t asked_utime_ = 0;
  std::optional<std::int64_t> deadline_utime_;
  int num_asked_ = 0;          ///< of the present step
  bool is_streaming_ = false;  ///< a sweep has come in this talk
  std::string trouble_;        ///< what the scanner says is wrong with it

 private:
  std::optional<std::int64_t> last_utime_;
  std::string failure_;
};

}  // namespace orchard::device
